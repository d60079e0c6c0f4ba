#include "run_start.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include "approach.hpp"
#include "interrupt.hpp"
#include "poses.hpp"

namespace asperity::command {
namespace {

constexpr double clearance_m = 0.003;  // the hand starts this far above the touch

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

result<std::vector<pose>> read_fixed_poses(const std::vector<std::string>& texts, std::size_t count) {
  if (texts.size() > count) {
    return error{error_code::invalid_argument, "there are more --fixed-pose than --fixed: give at most one for each"};
  }
  std::vector<pose> out(count);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const result<pose> T_wb = read_pose("--fixed-pose", texts[i]);
    if (!T_wb) return T_wb.error();
    out[i] = *T_wb;
  }
  return out;
}

result<given_poses> read_poses(const run_command& options) {
  result<std::vector<pose>> T_wb = read_fixed_poses(options.fixed_poses, options.fixed.size());
  if (!T_wb) return T_wb.error();
  given_poses out{std::nullopt, std::move(T_wb).value()};
  if (!options.probe_pose.empty()) {
    const result<pose> T_wa = read_pose("--probe-pose", options.probe_pose);
    if (!T_wa) return T_wa.error();
    out.T_wa = *T_wa;
  }
  return out;
}

result<pose> first_touch(any_renderer& feel, const std::vector<pose>& T_wb) {
  const step_function step = [&](const scene_pose& at, tick& out) { return feel.step(at, out); };
  return find_touch(feel.scene(), step, quat(1.0, 0.0, 0.0, 0.0), T_wb);
}

pose start_above(const run_command& options, pose touch_T_wa) {
  if (options.motion != "free") touch_T_wa.position.z += clearance_m;
  return touch_T_wa;
}

workspace_map map_of(const pose& T_wa_start, const vec3& centre_of_mass_a, double scale) {
  const quat& r = T_wa_start.rotation;
  return {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), T_wa_start * centre_of_mass_a},
          .scale = scale,
          .T_ha = {r, -(r * centre_of_mass_a)}};
}

workspace_map map_of(const pose& T_wa_start, const vec3& centre_of_mass_a, double scale, const pose& T_dh_start) {
  const vec3 grip_w = T_wa_start * centre_of_mass_a;
  const pose T_wh_start{T_dh_start.rotation, grip_w};
  return {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), grip_w - scale * T_dh_start.position},
          .scale = scale,
          .T_ha = inverse(T_wh_start) * T_wa_start};
}

result<pose> first_pose(any_device& device) {
  device_sample sample;
  constexpr std::int64_t longest_ns = 1'000'000'000;
  const std::int64_t begin_ns = steady_ns();
  for (std::int64_t now_ns = begin_ns; now_ns - begin_ns < longest_ns && !interrupted(); now_ns = steady_ns()) {
    if (device.read(now_ns, sample) == status::ok && has_all(sample.valid, sample_field::position)) return sample.T_dh;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (interrupted()) return error{error_code::cancelled, "interrupted before the device measured anything"};
  return error{error_code::io_failed,
               std::string(device.capabilities().name) +
                   " is open and measured nothing for a second: unplug it, plug it in again, and "
                   "see `asperity devices`"};
}

motion_settings motion_of(const run_command& options, const scene& bodies) {
  const double size = std::min(bodies.probe->box.diagonal(), bodies.fixed.front()->box.diagonal());
  motion_settings motion;
  motion.kind = options.motion == "press"   ? motion_kind::press
                : options.motion == "twist" ? motion_kind::twist
                : options.motion == "free"  ? motion_kind::free
                                            : motion_kind::scrub;
  // Oblique to both horizontal axes, so that ridges along either of them are felt.
  motion.sideways_d = {0.8, 0.6, 0.0};
  motion.depth_m = options.press_m + (options.probe_pose.empty() ? clearance_m / options.scale : 0.0);
  motion.amplitude_m = std::min(0.01, 0.1 * size / options.scale);
  return motion;
}

}  // namespace asperity::command
