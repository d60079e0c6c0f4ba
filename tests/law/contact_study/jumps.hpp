// How far a force jumps beyond what the motion explains, and how much work a closed loop makes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "law/contact_study/touching_pose.hpp"

namespace asperity::contact_study {

/// What the default keeps to, and the paper's does not.
inline constexpr double ratio_limit = 2.0;
inline constexpr double loop_limit = 1e-5;

/// What a probe feels somewhere.
struct felt {
  vec3 centre_of_mass_w{0.0};
  wrench on_probe_w{};  ///< about the centre of mass
  status answer = status::ok;

  [[nodiscard]] vec3 torque_about(const vec3& p_w) const noexcept {
    return on_probe_w.torque + glm::cross(centre_of_mass_w - p_w, on_probe_w.force);
  }
};

/// Feels the probe at a pose; the fixed body is the world.
using feel_function = std::function<felt(const pose& T_wa)>;

template <class Renderer>
[[nodiscard]] feel_function feel_with(Renderer& renderer) {
  return [&renderer](const pose& T_wa) {
    const pose T_wb;
    tick out;
    felt here;
    here.answer = renderer.step({T_wa, {&T_wb, 1}}, out);
    here.centre_of_mass_w = out.centre_of_mass_w;
    here.on_probe_w = out.force.on_probe_w;
    return here;
  };
}

/// Largest change of the wrench from tick to tick, in units of what one spring explains.
struct jump {
  double force = 0.0;   ///< max |dF| / (k dx), dx = |translation of the contact point| + L |rotation|
  double torque = 0.0;  ///< max |dT| / (k dx L), about the point of the contact
  double at_m = 0.0;    ///< where on the way the force changed most
  bool ok = true;       ///< false: a tick had another status than ok
};

/// One motion at 50 mm/s.
[[nodiscard]] inline jump measure_jump(const feel_function& feel, const touching_pose& start, motion m, double rate_hz,
                                       double stiffness_n_per_m) {
  constexpr double speed_m_per_s = 0.05;
  const auto ticks = static_cast<std::size_t>(std::lround(length_m(m) / speed_m_per_s * rate_hz));
  const vec3 point_a = inverse(start.T_wa) * start.point_w;
  jump worst;
  pose T_before;
  felt before;
  for (std::size_t i = 0; i <= ticks; ++i) {
    const double way_m = speed_m_per_s / rate_hz * static_cast<double>(i);
    const pose T = along(start, m, way_m);
    const felt now = feel(T);
    worst.ok = worst.ok && now.answer == status::ok;
    if (i > 0) {
      const vec3 point_w = T * point_a;
      const double turned_rad = glm::length(log_rotation(T.rotation * glm::conjugate(T_before.rotation)));
      const double dx = glm::length(point_w - T_before * point_a) + lever_m * turned_rad;
      const double force = glm::length(now.on_probe_w.force - before.on_probe_w.force) / (stiffness_n_per_m * dx);
      const double torque = glm::length(now.torque_about(point_w) - before.torque_about(T_before * point_a)) /
                            (stiffness_n_per_m * dx * lever_m);
      if (force > worst.force) worst.force = force, worst.at_m = way_m;
      worst.torque = std::max(worst.torque, torque);
    }
    T_before = T;
    before = now;
  }
  return worst;
}

/// Changes of the wrench within a tenth of a nanometre: what no finer look resolves. Those below `least_step_n` are not
/// looked for.
struct steps {
  std::size_t count = 0;
  double largest_n = 0.0;  ///< of the force, or of the torque about the point of the contact over L
  double at_m = 0.0;       ///< where on the way the largest is
};
inline constexpr double least_step_n = 5e-3;

/// One of the places of a path, and what the probe feels there.
struct path_place {
  double way = 0.0;
  pose T_wa;
  felt here;
};

/// Goes along a path in equal parts, each halved for as long as the wrench differs between its ends by more than
/// least_step_n (the torque about the point of the contact, over L) and it is longer than shortest. So a steep place
/// beside a step hides nothing; two steps within one part that cancel are not seen.
/// @param at   the pose at a way    @param visit called with both ends of each part and the change, N
template <class Path, class Visit>
void walk(const feel_function& feel, const touching_pose& start, double length, std::size_t parts, double shortest,
          Path&& at, Visit&& visit) {
  const vec3 point_a = inverse(start.T_wa) * start.point_w;
  const auto stop_at = [&](double way) {
    const pose T = at(way);
    return path_place{way, T, feel(T)};
  };
  const auto change_n = [&](const path_place& p, const path_place& q) {
    const double force = glm::length(q.here.on_probe_w.force - p.here.on_probe_w.force);
    const double torque = glm::length(q.here.torque_about(q.T_wa * point_a) - p.here.torque_about(p.T_wa * point_a));
    return std::max(force, torque / lever_m);
  };
  std::vector<path_place> ahead;  // the next is the last
  path_place from = stop_at(0.0);
  for (std::size_t i = 1; i <= parts; ++i) {
    ahead.push_back(stop_at(length * static_cast<double>(i) / static_cast<double>(parts)));
    while (!ahead.empty()) {
      const double change = change_n(from, ahead.back()), width = ahead.back().way - from.way;
      if (change > least_step_n && width > shortest) {
        ahead.push_back(stop_at(from.way + 0.5 * width));
        continue;
      }
      visit(from, ahead.back(), change);
      from = ahead.back();
      ahead.pop_back();
    }
  }
}

/// All steps of a motion.
[[nodiscard]] inline steps find_steps(const feel_function& feel, const touching_pose& start, motion m) {
  constexpr double longest_m = 5e-6, shortest_m = 1e-10;
  const auto parts = static_cast<std::size_t>(std::lround(length_m(m) / longest_m));
  steps out;
  walk(
      feel, start, length_m(m), parts, shortest_m, [&](double way_m) { return along(start, m, way_m); },
      [&](const path_place& from, const path_place&, double change) {
        if (!(change > least_step_n)) return;
        ++out.count;
        if (change > out.largest_n) out.largest_n = change, out.at_m = from.way;
      });
  return out;
}

/// The same motion at 1 kHz and at 10 kHz. Where a force is a continuous function of the pose, ticks that are ten times
/// shorter have jumps that are ten times smaller, and both measures are alike; where it jumps, the second is ten times
/// the first.
struct jumps {
  jump at_1khz, at_10khz;
  std::optional<steps> left;  ///< where it was asked for

  [[nodiscard]] double force_ratio() const noexcept { return ratio(at_10khz.force, at_1khz.force); }
  [[nodiscard]] double torque_ratio() const noexcept { return ratio(at_10khz.torque, at_1khz.torque); }
  [[nodiscard]] bool over_limit() const noexcept { return std::max(force_ratio(), torque_ratio()) > ratio_limit; }

 private:
  // A step of 0.1 mN, a hundredth of what a spring of 2 N/mm explains at 10 kHz, counts as none: no hand feels it, and a
  // search that ends within its tolerance makes steps of that size.
  [[nodiscard]] static double ratio(double at_10khz, double at_1khz) noexcept {
    constexpr double none = 1e-2;
    return std::max(at_10khz, none) / std::max(at_1khz, none);
  }
};

/// @param look_closer for steps too
[[nodiscard]] inline jumps measure_jumps(const feel_function& feel, const touching_pose& start, motion m,
                                         double stiffness_n_per_m, bool look_closer) {
  const auto at = [&](double rate_hz) { return measure_jump(feel, start, m, rate_hz, stiffness_n_per_m); };
  jumps out{at(1e3), at(1e4), std::nullopt};
  if (look_closer) out.left = find_steps(feel, start, m);
  return out;
}

/// Work once around the loop over the work of all its steps, both without sign: 0 for a force that has a potential, up
/// to the error of the trapezoidal rule.
[[nodiscard]] inline double loop_work(const feel_function& feel, const touching_pose& start, std::size_t parts = 2000) {
  constexpr double shortest = 1e-7;  // of the loop: a fraction of a nanometre
  double work = 0.0, turnover = 0.0;
  walk(
      feel, start, 1.0, parts, shortest, [&](double turn) { return around(start, turn); },
      [&](const path_place& from, const path_place& to, double) {
        const vec3 moved_m = to.here.centre_of_mass_w - from.here.centre_of_mass_w;
        const vec3 turned_rad = log_rotation(to.T_wa.rotation * glm::conjugate(from.T_wa.rotation));
        const double part = 0.5 * (glm::dot(from.here.on_probe_w.force + to.here.on_probe_w.force, moved_m) +
                                   glm::dot(from.here.on_probe_w.torque + to.here.on_probe_w.torque, turned_rad));
        work += part;
        turnover += std::fabs(part);
      });
  return turnover > 0.0 ? std::fabs(work) / turnover : 0.0;
}

}  // namespace asperity::contact_study
