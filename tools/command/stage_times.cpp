#include "stage_times.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <thread>
#include <utility>

#include "approach.hpp"
#include "asperity/control/control_settings.hpp"
#include "asperity/control/linearise.hpp"
#include "asperity/control/probe_motion.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "cpu_clock.hpp"
#include "interrupt.hpp"

namespace asperity::command {
namespace {

/// Poses of a probe that scrubs over the place where it first touched, pressed in by a little.
std::vector<pose> scrubbing_path(const pose& touch, const scrubbing& motion, double size_m) {
  std::mt19937_64 bits(motion.seed);
  const auto unit = [&] { return static_cast<double>(bits() >> 11) * 0x1.0p-53; };
  constexpr double two_pi = 6.283185307179586;
  const double amplitude_m = std::min(0.01, 0.1 * size_m);
  const double press_m = std::min(0.0005, 0.005 * size_m);
  const double phase[] = {two_pi * unit(), two_pi * unit(), two_pi * unit()};
  std::vector<pose> path;
  for (std::size_t i = 0; i < motion.poses; ++i) {
    // A thousand poses a second, as a device loop would ask for.
    const double t = 1e-3 * static_cast<double>(i);
    pose T = touch;
    T.position += vec3(amplitude_m * (std::sin(two_pi * 1.0 * t + phase[0]) - std::sin(phase[0])),
                       amplitude_m * (std::sin(two_pi * 0.7 * t + phase[1]) - std::sin(phase[1])), -press_m);
    T.rotation = exp_rotation({0.0, 0.0, 0.05 * std::sin(two_pi * 0.4 * t + phase[2])}) * touch.rotation;
    path.push_back(T);
  }
  return path;
}

/// A pose whose deepest sample is at the surface, as a loop keeps it.
pose lifted(plane_renderer& feel, scene_pose at) {
  pose T_wa = at.T_wa;
  for (int i = 0; i < 4; ++i) {
    tick found;
    static_cast<void>(feel.step({T_wa, at.T_wb}, found));
    double deepest_m = -1.0;
    for (const support_plane& p : found.planes) deepest_m = std::max(deepest_m, p.depth_m);
    if (found.planes.empty()) break;
    T_wa.position.z += deepest_m;
  }
  return T_wa;
}

/// The sum of depths and slopes of all samples that the last tick found near, each of them read in full: a number that
/// no compiler can do without a reading for.
double sum_of_all(plane_renderer& feel, const scene_pose& at) {
  const field_scene& fields = feel.depth().bodies();
  double sum = 0.0;
  for (const near_patch& patch : feel.found().patches()) {
    const pose T_ba = inverse(at.T_wb[patch.body]) * at.T_wa;
    const pose T_yx = patch.of_probe ? T_ba : inverse(T_ba);
    const body_field& in_y = patch.of_probe ? fields.fixed[patch.body]->field : fields.probe->field;
    for (const near_leaf& leaf : feel.found().leaves_of(patch)) {
      for (const field_sample& s : leaf.samples()) {
        const field_reading d = in_y.read(T_yx * vec3(s.position_b));
        sum += d.value_m + d.slope.x + d.slope.y + d.slope.z;
      }
    }
  }
  return sum;
}

/// A probe that follows the path as a device thread moves it, on contacts of the path's surface.
class led_probe {
 public:
  led_probe(const textured_model& probe, double friction)
      : T_ac_{quat(1.0, 0.0, 0.0, 0.0), probe.mass.centre_of_mass},
        motion_(solid_probe(probe.mass), {}, contact_laws{}, control_settings{}.substeps, rubs(friction)) {}

  /// What a contact thread makes of a tick.
  void take(const tick& found, const scene_pose& at) noexcept {
    if (!placed_) motion_.place(at.T_wa * T_ac_);
    placed_ = true;
    const pose then_T_wc = at.T_wa * T_ac_;
    coupling_pull pull = motion_.coupling().pull(motion_.target(), then_T_wc);
    pull.on_probe_w += motion_.rubbing().on_probe_w();
    linearise(found, status::ok, {.T_wc = then_T_wc, .pull = pull, .bodies = {}}, selection_for(1'000'000), rest_,
              contact_);
  }
  /// A device tick of a millisecond towards a pose of the hand.
  status follow(const pose& T_wa) noexcept { return motion_.move(1e-3, T_wa * T_ac_, 1.0, contact_); }
  [[nodiscard]] const linear_contact& contact() const noexcept { return contact_; }

 private:
  [[nodiscard]] static friction_settings rubs(double coefficient) noexcept {
    friction_settings out;
    out.static_coefficient = out.dynamic_coefficient = coefficient;
    return out;
  }

  pose T_ac_;
  probe_motion motion_;
  rest_prediction rest_;
  linear_contact contact_{};
  bool placed_ = false;
};

/// The same scene with many more of its first fixed body, all out of reach.
struct crowd {
  scene bodies;
  std::shared_ptr<const field_scene> fields;
  std::vector<pose> T_wb;

  crowd(const scene& alone, const field_scene& made, const std::vector<pose>& T_wb_alone)
      : bodies(alone), T_wb(T_wb_alone) {
    field_scene all = made;
    const double apart_m = 2.0 * (alone.probe->box.diagonal() + alone.fixed.front()->box.diagonal());
    for (std::size_t i = 0; i < far_bodies; ++i) {
      bodies.fixed.push_back(alone.fixed.front());
      all.fixed.push_back(made.fixed.front());
      const std::size_t row = 1 + i / 10, column = i % 10;
      T_wb.push_back(
          {quat(1.0, 0.0, 0.0, 0.0), {apart_m * static_cast<double>(row), apart_m * static_cast<double>(column), 0.0}});
    }
    fields = std::make_shared<const field_scene>(std::move(all));
  }
};

}  // namespace

result<stage_times> time_stages(const scene& bodies, const scrubbing& motion, progress_line& progress) {
  window_renderer_settings soft_settings, central_settings;
  soft_settings.depth.gradient = gradient_scheme::soft_max;
  central_settings.depth.gradient = gradient_scheme::central_difference;
  result<least_motion_renderer> least = make_renderer(bodies);
  if (!least) return least.error();
  result<window_renderer> soft = make_window_renderer(bodies, soft_settings);
  if (!soft) return soft.error();
  result<window_renderer> central = make_window_renderer(bodies, central_settings);
  if (!central) return central.error();

  result<field_scene> fields = make_field_scene(bodies);
  if (!fields) return fields.error();
  const auto made = std::make_shared<const field_scene>(std::move(fields).value());
  const plane_renderer_settings plane_settings{.reach_m = reach_for(1e-3)};
  result<plane_renderer> planes = make_plane_renderer(bodies, made, plane_settings);
  if (!planes) return planes.error();

  plane_renderer_settings shared_settings = plane_settings;
  shared_settings.threads = motion.threads;
  result<plane_renderer> follow = make_plane_renderer(bodies, made, plane_settings);
  if (!follow) return follow.error();
  result<plane_renderer> follow_shared = make_plane_renderer(bodies, made, shared_settings);
  if (!follow_shared) return follow_shared.error();
  const bool has_processors = std::thread::hardware_concurrency() >= motion.threads;

  const std::vector<pose> T_wb(bodies.fixed.size());
  const crowd others(bodies, *made, T_wb);
  result<plane_renderer> planes_far = make_plane_renderer(others.bodies, others.fields, plane_settings);
  if (!planes_far) return planes_far.error();
  result<window_renderer> soft_far = make_window_renderer(others.bodies, soft_settings);
  if (!soft_far) return soft_far.error();

  const step_function step = [&](const scene_pose& at, tick& found) { return soft->step(at, found); };
  const result<pose> touch = find_touch(bodies, step, quat(1.0, 0.0, 0.0, 0.0), T_wb);
  if (!touch) return touch.error();
  const double size_m = std::min(bodies.probe->box.diagonal(), bodies.fixed.front()->box.diagonal());

  stage_times out;
  convex_piece_finder finder(bodies, soft_settings.finder);
  contact_set contacts(soft_settings.limits);
  std::vector<penetration> depths(soft_settings.limits.contacts);
  const std::vector<pose> path = scrubbing_path(*touch, motion, size_m);
  led_probe smooth(*bodies.probe, 0.0), rubbing(*bodies.probe, 0.4);
  const auto time = [](std::vector<double>& into, double share, auto&& call) {
    const double begin = cpu_seconds();
    static_cast<void>(call());
    into.push_back(share * (cpu_seconds() - begin));
  };
  const auto time_on_wall = [](std::vector<double>& into, auto&& call) {
    const auto begin = std::chrono::steady_clock::now();
    static_cast<void>(call());
    into.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (interrupted()) return error{error_code::cancelled, "interrupted: nothing was written"};
    progress.show("measuring", static_cast<double>(i) / static_cast<double>(path.size()));
    const scene_pose at{path[i], T_wb};
    time(out.query_s, 1.0, [&] { return finder.find(at, contacts); });
    out.contacts.push_back(static_cast<double>(contacts.size()));
    if (contacts.size() > 0) {
      const auto found = std::span(depths).first(contacts.size());
      const double share = 1.0 / static_cast<double>(contacts.size());
      time(out.soft_contact_s, share, [&] { return soft->depth().measure(at, contacts, found); });
      time(out.central_contact_s, share, [&] { return central->depth().measure(at, contacts, found); });
    }
    const scene_pose at_surface{lifted(*planes, at), T_wb};
    tick found;
    time(out.planes_tick_s, 1.0, [&] { return planes->step(at_surface, found); });
    out.planes_work.push_back(found.work);
    time_on_wall(out.follow_s, [&] { return follow->step(at_surface, found); });
    if (has_processors) time_on_wall(out.follow_shared_s, [&] { return follow_shared->step(at_surface, found); });
    smooth.take(found, at_surface);
    rubbing.take(found, at_surface);
    out.planes_held.push_back(static_cast<double>(rubbing.contact().planes.size()));
    time(out.probe_s, 1.0, [&] { return smooth.follow(at.T_wa); });
    time(out.rubbing_probe_s, 1.0, [&] { return rubbing.follow(at.T_wa); });
    time(out.every_sample_s, 1.0, [&] {
      out.sum_of_samples += sum_of_all(*planes, at_surface);
      return status::ok;
    });
    time(out.least_motion_tick_s, 1.0, [&] { return least->step(at, found); });
    time(out.soft_tick_s, 1.0, [&] { return soft->step(at, found); });
    // After the same ticks as the other renderer has made: what earlier ticks know makes the next one faster.
    static_cast<void>(lifted(*planes_far, {at.T_wa, others.T_wb}));
    time(out.planes_far_tick_s, 1.0, [&] { return planes_far->step({at_surface.T_wa, others.T_wb}, found); });
    time(out.soft_far_tick_s, 1.0, [&] { return soft_far->step({at.T_wa, others.T_wb}, found); });
    time(out.central_tick_s, 1.0, [&] { return central->step(at, found); });
  }
  if (out.soft_contact_s.empty()) {
    return error{error_code::invalid_argument, "the probe lost the fixed body along the path: choose other models"};
  }
  return out;
}

}  // namespace asperity::command
