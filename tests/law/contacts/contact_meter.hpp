// What the tests of contacts measure with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "contact_scenes.hpp"
#include "support/kept_bodies.hpp"

namespace asperity::contacts_test {

using test_support::build_renderer;

inline constexpr double stiffness_n_per_m = 2000.0;

/// What the acceptance numbers are stated for: this stiffness, and the softness of a loop of 1 kHz.
[[nodiscard]] inline least_motion_renderer_settings scene_settings() {
  least_motion_renderer_settings s;
  s.force.stiffness_n_per_m = stiffness_n_per_m;
  return s;
}

/// The value of a result, or an exception that fails the test.
template <class T>
[[nodiscard]] T value_of(result<T> made) {
  if (!made) throw std::runtime_error(made.error().message);
  return std::move(made).value();
}

[[nodiscard]] inline least_motion_renderer make_scene_renderer(const contact_scene& s,
                                                               const least_motion_renderer_settings& settings,
                                                               const model_plan& plan = {}) {
  return value_of(build_renderer({make_model(s.probe, plan), {make_model(s.fixed, plan)}}, settings));
}

/// Wrench on the probe, fixed body at the origin.
template <class Renderer>
[[nodiscard]] wrench wrench_at(Renderer& r, const pose& T_wa) {
  const std::array<pose, 1> fixed{};
  tick out;
  if (r.step({T_wa, fixed}, out) != status::ok) throw std::runtime_error("a step of the renderer failed");
  return out.force.on_probe_w;
}

/// How far apart two poses are, a radian counting as `lever_m`.
[[nodiscard]] inline double distance(const pose& a, const pose& b, double lever_m) {
  return glm::length(b.position - a.position) +
         lever_m * glm::length(log_rotation(b.rotation * glm::conjugate(a.rotation)));
}

/// Length of a scene's path, m.
[[nodiscard]] inline double path_length(const contact_scene& s) {
  double length = 0.0;
  for (int i = 0; i < 1000; ++i) length += distance(s.path(i / 1000.0), s.path((i + 1) / 1000.0), s.lever_m);
  return length;
}

/// One tick's change of the wrench over what a spring k would change by for the same motion.
struct tick_change {
  double at = 0.0;  ///< path parameter at the end of the tick
  double force = 0.0, torque = 0.0;

  [[nodiscard]] double worse() const { return std::max(force, torque); }
};

/// Changes between path parameters `from` and `to` in `ticks` equal steps.
template <class Renderer>
[[nodiscard]] std::vector<tick_change> walk(Renderer& r, const contact_scene& s, double from, double to,
                                            std::size_t ticks) {
  std::vector<tick_change> out;
  pose last = s.path(from);
  wrench before = wrench_at(r, last);
  for (std::size_t i = 1; i <= ticks; ++i) {
    const double t = from + (to - from) * static_cast<double>(i) / static_cast<double>(ticks);
    const pose now = s.path(t);
    const wrench after = wrench_at(r, now);
    const wrench change = after - before;
    const double expected = stiffness_n_per_m * distance(last, now, s.lever_m);
    out.push_back({t, glm::length(change.force) / expected, glm::length(change.torque) / (expected * s.lever_m)});
    last = now;
    before = after;
  }
  return out;
}

[[nodiscard]] inline tick_change largest(const std::vector<tick_change>& ticks) {
  tick_change out;
  for (const tick_change& t : ticks) {
    if (t.force > out.force) out.at = t.at;
    out.force = std::max(out.force, t.force);
    out.torque = std::max(out.torque, t.torque);
  }
  return out;
}

/// Largest changes at 1 kHz and 10 kHz along the same path at 50 mm/s, and at 100 kHz wherever 10 kHz has more than twice
/// the largest of 1 kHz.
struct continuity {
  tick_change slow, fast;
  std::optional<tick_change> fastest{};

  /// Ten where the wrench jumps, one where it does not. A jump is ten times as steep at every next rate; what falls by a
  /// steep slope within one tick of 1 kHz is as steep at 100 kHz as at 10 kHz.
  [[nodiscard]] double force_ratio() const {
    const double first = ratio(fast.force, slow.force);
    return fastest ? std::min(first, ratio(fastest->force, fast.force)) : first;
  }
  [[nodiscard]] double torque_ratio() const {
    const double first = ratio(fast.torque, slow.torque);
    return fastest ? std::min(first, ratio(fastest->torque, fast.torque)) : first;
  }

 private:
  // From a thousandth of what a spring explains on; below it a difference is the rounding of two forces.
  [[nodiscard]] static double ratio(double change, double of) { return std::max(change, 1e-3) / std::max(of, 1e-3); }
};

inline constexpr double slow_step_m = 0.05 * mm;  ///< 50 mm/s for a millisecond

/// Walks the path at 1 kHz, and a part of it at 10 kHz: the worst tenth of the ticks, and every `stride`-th of the
/// others. A wrench that jumps within a tick has jumped at its end too, so the worst ticks are where the jumps are.
template <class Renderer>
[[nodiscard]] continuity measure_continuity(Renderer& r, const contact_scene& s, std::size_t stride) {
  const auto ticks = static_cast<std::size_t>(path_length(s) / slow_step_m);
  std::vector<tick_change> slow = walk(r, s, 0.0, 1.0, ticks);
  std::stable_sort(slow.begin(), slow.end(),
                   [](const tick_change& a, const tick_change& b) { return a.worse() > b.worse(); });
  const double length = 1.0 / static_cast<double>(ticks);
  const tick_change at_slow = largest(slow);
  std::vector<tick_change> fast, fastest;
  for (std::size_t i = 0; i < slow.size(); ++i) {
    if (i > slow.size() / 10 && i % stride != 0) continue;
    fast.push_back(largest(walk(r, s, slow[i].at - length, slow[i].at, 10)));
    if (fast.back().force > 2.0 * at_slow.force || fast.back().torque > 2.0 * at_slow.torque) {
      fastest.push_back(largest(walk(r, s, slow[i].at - length, slow[i].at, 100)));
    }
  }
  continuity out{at_slow, largest(fast)};
  if (!fastest.empty()) {
    out.fastest = largest(fastest);
    std::printf("%-14s |dF| %6.3f at 100 kHz, |dT| %6.3f, in the %zu ticks that are twice as steep at 10 kHz\n",
                s.name.c_str(), out.fastest->force, out.fastest->torque, fastest.size());
  }
  return out;
}

/// Rotation about the probe's centre of mass and translation of it, world axes.
[[nodiscard]] inline pose moved(const pose& T_wa, const vec3& centre_b, const vec3& translation, const vec3& rotation) {
  const quat turned = exp_rotation(rotation) * T_wa.rotation;
  return {turned, T_wa * centre_b + translation - turned * centre_b};
}

/// Relief of 0.1 mm from peak to valley, without a direction of its own.
[[nodiscard]] inline relief waves(double wavelength_m) {
  return [k = 2.0 * std::numbers::pi / wavelength_m](const vec3& p, const vec3&) {
    return 0.05 * mm * std::sin(k * (p.x + 0.31 * p.y + 0.2 * p.z)) *
           std::cos(k * (0.83 * p.y - 0.37 * p.z - 0.11 * p.x) + 0.3);
  };
}

/// A renderer of the scene, plain or with waves on both bodies.
[[nodiscard]] inline least_motion_renderer make_waved_renderer(const contact_scene& s, bool textured,
                                                               const least_motion_renderer_settings& settings) {
  model_plan probe, fixed;
  if (textured) {
    probe.height = waves(3.7 * mm);
    fixed.height = waves(4.3 * mm);
  }
  return value_of(build_renderer({make_model(s.probe, probe), {make_model(s.fixed, fixed)}}, settings));
}

}  // namespace asperity::contacts_test
