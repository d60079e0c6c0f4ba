// One way out: where a spring that pulls back and the bed that pushes out are in balance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"
#include "core/cholesky.hpp"
#include "least_motion/bed.hpp"
#include "least_motion/motion.hpp"
#include "least_motion/posed_samples.hpp"

namespace asperity::exits {

/// Springs of the law, N/m: see exit_rule.
struct exit_springs {
  double one = 0.0;    ///< to the pose, where there is one way out
  double each = 0.0;   ///< to the place y, where there are several
  double mixed = 0.0;  ///< bound of the force's slope where several are mixed

  /// The spring's energy of a way out as seen from y, and the place y that belongs to ways out with this mean.
  [[nodiscard]] double pull_j(const vec3& z, const vec3& y) const noexcept {
    return 0.5 * each * glm::dot(z - y, z - y);
  }
  [[nodiscard]] vec3 seen_from(const vec3& mean_z) const noexcept { return (-each / (mixed - each)) * mean_z; }
};

/// A motion of the probe that clears the bodies, up to how far the bed gives way.
struct way_out {
  vec3 z_w{0.0};     ///< of the pivot
  vec3 turn_w{0.0};  ///< about the pivot, rad
  bed_sum bed;
  double weight = 0.0;
  bool settled = true;             ///< false: the iteration ended before it came to rest
  bool looked_beside = false;      ///< descents from beside it were made
  fixed_vector<mark, 8> touching;  ///< the deepest samples there
  wrench on_probe_w{};             ///< its part of what the probe feels, about c_A; set once all have their weights

  [[nodiscard]] motion moved() const noexcept { return {z_w, turn_w}; }
  /// Cost as seen from y, J.
  [[nodiscard]] double cost_j(const exit_springs& k, const vec3& y) const noexcept {
    return k.pull_j(z_w, y) + bed.energy_j;
  }
};

/// Keeps the deepest of the marks it is given. @rt safe
template <std::size_t N>
void keep_deepest(fixed_vector<mark, N>& among, const mark& m) noexcept {
  if (among.push_back(m)) return;
  auto shallowest =
      std::min_element(among.begin(), among.end(), [](const mark& a, const mark& b) { return a.depth_m < b.depth_m; });
  if (shallowest->depth_m < m.depth_m) *shallowest = m;
}

/// Springs of a way out that is being settled.
struct settling {
  double k_n_per_m = 0.0;  ///< pulls back to y
  vec3 y_w{0.0};
  double turn_n_m_per_rad = 0.0;  ///< resists the turn
};

/// Finds the minimum of k/2 |z - y|^2 + bed(z, turn) near a motion by Newton's method, exact first and second
/// derivatives. Where the sum is not convex, or a step does not lead down, the step is damped.
/// @rt safe: at most 60 steps, and no more readings than are left
[[nodiscard]] inline way_out settle(const settling& by, motion x, const bed_rule& rule, bed_patch& patch,
                                    posed_samples& samples) noexcept {
  constexpr int most_steps = 60, most_dampings = 40;
  constexpr double longest_step_m = 2e-4;
  constexpr double rounded_m = 1e-16;  // rounding of places in a body of a decimetre
  // Turns count as the way that they move a point an arm away.
  const double k = by.k_n_per_m, arm_m = std::sqrt(std::max(1e-12, by.turn_n_m_per_rad / k));
  way_out out;
  out.bed = patch.at(x, by.turn_n_m_per_rad, rule, samples);
  const auto cost = [&](const motion& at, const bed_sum& bed) {
    return 0.5 * k * glm::dot(at.shift_w - by.y_w, at.shift_w - by.y_w) + bed.energy_j;
  };
  const auto residual = [&](const motion& at, const bed_sum& bed) {
    return vec6{k * (at.shift_w - by.y_w) + bed.gradient.linear, bed.gradient.angular / arm_m};
  };
  double cost_j = cost(x, out.bed), damping = 0.0, before = std::numeric_limits<double>::infinity();
  out.settled = false;
  for (int step = 0; step < most_steps && !out.settled && samples.count.left(); ++step) {
    const vec6 r = residual(x, out.bed);
    const double left = std::sqrt(dot(r, r)), scale = 1e-12 + glm::length(out.bed.gradient.linear);
    // Below a millionth the steps go on as long as they help, until rounding ends the progress.
    if (left < 1e-9 * scale || (left < 1e-6 * scale && left > 0.3 * before)) {
      out.settled = true;
      break;
    }
    before = left;
    bool moved = false;
    for (int n = 0; n < most_dampings && !moved; ++n) {
      mat6 h;
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
          h(i, j) = out.bed.hessian(i, j) / ((i < 3 ? 1.0 : arm_m) * (j < 3 ? 1.0 : arm_m));
        }
        h(i, i) += damping + (i < 3 ? k : 0.0);
      }
      const cholesky6 factors(h);
      if (!factors.positive()) {
        damping = damping > 0.0 ? 4.0 * damping : 0.5 * k;
        continue;
      }
      vec6 dx = -1.0 * factors.solve(r);
      const double length = std::max(glm::length(dx.linear), glm::length(dx.angular));
      if (length > longest_step_m) dx = (longest_step_m / length) * dx;
      const motion next(x.shift_w + dx.linear, x.turn_w + dx.angular / arm_m);
      const bed_sum bed = patch.at(next, by.turn_n_m_per_rad, rule, samples);
      const double now_j = cost(next, bed);
      // Near rest two places have the same cost to rounding, soon so under a light touch; the residual still differs.
      const vec6 now_r = residual(next, bed);
      const double now_left = std::sqrt(dot(now_r, now_r));
      if (now_j < cost_j * (1.0 - 1e-14) || (now_j <= cost_j * (1.0 + 1e-13) + rounded_m * scale && now_left < left)) {
        moved = true;
        x = next;
        out.bed = bed;
        cost_j = now_j;
        damping = damping < 1e-2 * k ? 0.0 : 0.1 * damping;
      } else {
        damping = damping > 0.0 ? 8.0 * damping : k;
      }
    }
    if (!moved) {
      out.settled = left < 1e-6 * scale;
      break;
    }
  }
  out.z_w = x.shift_w;
  out.turn_w = x.turn_w;
  patch.for_each_inside(x, samples, [&](const mark& m, const coarse_reading& d) noexcept {
    mark here = m;
    here.depth_m = d.value_m;
    keep_deepest(out.touching, here);
  });
  return out;
}

}  // namespace asperity::exits
