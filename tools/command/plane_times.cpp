#include "plane_times.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <utility>

#include "approach.hpp"
#include "asperity/gl/plane_batch.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "interrupt.hpp"
#include "statistics.hpp"
#include "wall_seconds.hpp"

namespace asperity::command {
namespace {

error not_answered(status s) {
  return {error_code::unsupported,
          std::string("the planes of many poses were not told (") + to_string(s) + "): the ratios would mean nothing"};
}

/// Where the bodies are, at the same moment for every pose but the probe's.
struct drawn_poses {
  std::vector<pose> T_wb;
  std::vector<pose> T_wa;

  [[nodiscard]] std::vector<scene_pose> all() const {
    std::vector<scene_pose> out;
    for (const pose& T : T_wa) out.push_back({T, T_wb, 0.0});
    return out;
  }
};

result<drawn_poses> draw(const scene& bodies, plane_renderer& feel, std::size_t poses, std::uint64_t seed) {
  drawn_poses out;
  out.T_wb.resize(bodies.fixed.size());
  const step_function step = [&](const scene_pose& at, tick& found) { return feel.step(at, found); };
  const result<pose> touch = find_touch(bodies, step, quat(1.0, 0.0, 0.0, 0.0), out.T_wb);
  if (!touch) return touch.error();
  std::mt19937_64 bits(seed);
  const auto unit = [&] { return 2.0 * static_cast<double>(bits() >> 11) * 0x1.0p-53 - 1.0; };
  for (std::size_t i = 0; i < poses; ++i) {
    const quat turn = glm::normalize(quat(1.0, 0.025 * unit(), 0.025 * unit(), 0.025 * unit()));
    const vec3 shift(0.002 * unit(), 0.002 * unit(), -0.0005 * (1.0 + unit()));
    out.T_wa.push_back({turn * touch->rotation, touch->position + shift});
  }
  return out;
}

/// What ticks on the processor say, kept so that the device's answer can be judged.
struct ticks_told {
  std::vector<double> depth_m;
  std::vector<vec3> force_w;
};

status one_by_one(plane_renderer& feel, std::span<const scene_pose> at, tick& t, ticks_told& told) {
  for (std::size_t i = 0; i < at.size(); ++i) {
    const status s = feel.step(at[i], t);
    if (s != status::ok && s != status::capacity_reached) return s;
    told.depth_m[i] = t.depths.empty() ? 0.0 : std::max(0.0, t.depths[0].depth_m);
    told.force_w[i] = t.force.on_probe_w.force;
  }
  return status::ok;
}

void judge(bench_of_planes& out, std::span<const gl::pose_planes> planes, const ticks_told& told) {
  std::vector<double> apart;
  double largest = 0.0;
  std::size_t too_deep = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].left_out != 0) {
      ++too_deep;
      continue;
    }
    const double depth_m = planes[i].deepest.empty() ? 0.0 : planes[i].deepest[0].plane.depth_m;
    out.depth_apart_m = std::max(out.depth_apart_m, std::fabs(depth_m - told.depth_m[i]));
    const wrench push = gl::push_of(planes[i], plane_spring_settings{}.stiffness_n_per_m);
    apart.push_back(glm::length(push.force - told.force_w[i]));
    largest = std::max(largest, glm::length(told.force_w[i]));
  }
  out.too_deep = static_cast<double>(too_deep) / static_cast<double>(planes.size());
  if (apart.empty() || largest == 0.0) return;
  const auto p99 = apart.begin() + static_cast<std::ptrdiff_t>((apart.size() - 1) * 99 / 100);
  std::nth_element(apart.begin(), p99, apart.end());
  out.force_apart = *p99 / largest;
}

/// One pose, a few and all of them; the device and the processor in turn.
result<void> time_sizes(bench_of_planes& out, gl::plane_batch& batch, plane_renderer& feel,
                        const std::vector<scene_pose>& at, std::size_t repeats, progress_line& progress) {
  std::vector<gl::pose_planes> planes(at.size());
  ticks_told told{std::vector<double>(at.size()), std::vector<vec3>(at.size())};
  tick t;
  for (const std::size_t n : {std::size_t{1}, std::size_t{16}, at.size()}) {
    const auto some = std::span(at).first(n);
    const auto answers = std::span(planes).first(n);
    poses_timed& timed = out.sizes.emplace_back(poses_timed{.poses = n, .gpu_s = {}, .cpu_s = {}});
    status answered = batch.measure(some, answers);  // not counted: the driver may compile for a new size
    for (std::size_t i = 0; i < std::max<std::size_t>(1, repeats); ++i) {
      if (interrupted()) return error{error_code::cancelled, "interrupted: nothing was written"};
      progress.show("planes of " + std::to_string(n) + " poses", static_cast<double>(i) / static_cast<double>(repeats));
      if (answered != status::ok && answered != status::capacity_reached) return not_answered(answered);
      timed.gpu_s.push_back(wall_seconds([&] { answered = batch.measure(some, answers); }));
      if (answered != status::ok && answered != status::capacity_reached) return not_answered(answered);
      timed.cpu_s.push_back(wall_seconds([&] { answered = one_by_one(feel, some, t, told); }));
      if (answered != status::ok) return not_answered(answered);
    }
    timed.ratio = summarise(timed.gpu_s).p50_s / summarise(timed.cpu_s).p50_s;
  }
  judge(out, planes, told);
  return {};
}

}  // namespace

result<std::vector<bench_of_planes>> time_planes(const scene& bodies, const gl::context_ptr& context, std::size_t poses,
                                                 std::size_t repeats, std::uint64_t seed, progress_line& progress) {
  result<field_scene> fields = make_field_scene(bodies);
  if (!fields) return fields.error();
  const auto shared = std::make_shared<const field_scene>(std::move(fields).value());
  result<plane_renderer> feel = make_plane_renderer(bodies, shared);
  if (!feel) return feel.error();
  const result<drawn_poses> drawn = draw(bodies, *feel, poses, seed);
  if (!drawn) return drawn.error();

  std::vector<bench_of_planes> both;
  for (const gl::arithmetic with : {gl::arithmetic::double_precision, gl::arithmetic::single_precision}) {
    const bool is_double = with == gl::arithmetic::double_precision;
    if (is_double && !context->facts().double_precision) continue;
    bench_of_planes out{.arithmetic = is_double ? "double" : "single", .sizes = {}};
    const std::size_t before = context->device_bytes();
    result<gl::plane_batch> batch = error{error_code::unsupported, ""};
    out.set_up_s = wall_seconds(
        [&] { batch = gl::plane_batch::make(context, bodies, shared, {.poses = poses, .arithmetic = with}); });
    if (!batch) return batch.error();
    out.device_bytes = context->device_bytes() - before;
    if (result<void> ok = time_sizes(out, *batch, *feel, drawn->all(), repeats, progress); !ok) return ok.error();
    both.push_back(std::move(out));
  }
  return both;
}

}  // namespace asperity::command
