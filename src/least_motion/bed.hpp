// The stiff bed that the samples make, and its sum near one place.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "least_motion/motion.hpp"
#include "least_motion/posed_samples.hpp"

namespace asperity::exits {

/// Cost of one sample at depth D. Its push rises from zero without a kink: stiffness D^2 / (D + onset).
/// One sample and a face of thousands hold alike, because the bed is far stiffer than the spring that presses on it.
struct bed_rule {
  double stiffness_n_per_m = 0.0;
  double onset_m = 0.0;  ///< several times deeper than this, the push grows with the full stiffness

  /// Integral of the push, J.   @pre depth_m >= 0
  [[nodiscard]] double energy_j(double depth_m) const noexcept {
    const double u = depth_m / onset_m, scale = stiffness_n_per_m * onset_m * onset_m;
    // The three terms cancel to third order; below this depth the series is more exact.
    if (u < 1e-2) return scale * u * u * u * (1.0 / 3.0 + u * (-0.25 + u * (0.2 - u * (1.0 / 6.0 - u / 7.0))));
    return scale * (0.5 * u * u - u + std::log1p(u));
  }
  [[nodiscard]] double push_n(double depth_m) const noexcept {
    return stiffness_n_per_m * depth_m * depth_m / (depth_m + onset_m);
  }
  /// Derivative of the push, N/m.
  [[nodiscard]] double rise_n_per_m(double depth_m) const noexcept {
    const double d = depth_m + onset_m;
    return stiffness_n_per_m * depth_m * (depth_m + 2.0 * onset_m) / (d * d);
  }
};

/// The bed at one motion of the probe: energy, and its derivatives by the motion, world axes. The spring that resists
/// the turn is in it.
struct bed_sum {
  double energy_j = 0.0;
  double deepest_m = 0.0;  ///< 0 where no sample is inside
  vec6 gradient;           ///< by shift and turn: N, N m
  mat6 hessian;
};

/// Adds s A^T h A to one half of a matrix, A = (1, -[arm]): a sample's second derivatives by shift and turn.
/// @rt safe
inline void add_at_arm(mat6& to, double s, const mat3& h, const vec3& arm) noexcept {
  vec3 by_turn[3];  // column j of h (-[arm]): h (e_j x arm)
  for (int j = 0; j < 3; ++j) {
    vec3 axis(0.0);
    axis[j] = 1.0;
    by_turn[j] = s * (h * glm::cross(axis, arm));
  }
  for (std::size_t j = 0; j < 3; ++j) {
    const int c = static_cast<int>(j);
    const vec3 down = glm::cross(arm, by_turn[c]);  // -[arm]^T v = arm x v
    for (std::size_t i = 0; i < 3; ++i) {
      const int r = static_cast<int>(i);
      to(i, j) += s * h[c][r];
      to(i, j + 3) += by_turn[c][r];
      to(j + 3, i) += by_turn[c][r];
      to(i + 3, j + 3) += down[r];
    }
  }
}

/// The samples that can be inside at motions near one place: gathered once, summed often.
class bed_patch {
 public:
  /// @param most marks that are kept; further ones are left out and reported
  explicit bed_patch(std::size_t most) { detail::reserve_resident(marks_, most); }

  /// Forgets what was gathered. @rt safe
  void clear() noexcept {
    marks_.clear();
    gathered_ = false;
    crowded = false;
  }

  /// The bed at x; gathers anew where x is more than reach_m from the last place.
  /// @param turn_n_m_per_rad the spring that resists the turn   @rt safe
  [[nodiscard]] bed_sum at(const motion& x_w, double turn_n_m_per_rad, const bed_rule& rule,
                           posed_samples& samples) noexcept {
    if (!covers(x_w, samples)) gather(x_w, samples);
    bed_sum out;
    for_each_inside(x_w, samples, [&](const mark& m, const coarse_reading& d) noexcept {
      const double push = rule.push_n(d.value_m), rise = rule.rise_n_per_m(d.value_m);
      const vec3 arm = samples.arm_w(m);
      const vec6 slope{d.slope, glm::cross(arm, d.slope)};
      out.deepest_m = std::max(out.deepest_m, d.value_m);
      out.energy_j += rule.energy_j(d.value_m);
      out.gradient += push * slope;
      add_outer(out.hessian, rise, slope);
      add_at_arm(out.hessian, push, d.hessian_per_m, arm);
    });
    out.energy_j += 0.5 * turn_n_m_per_rad * glm::dot(x_w.turn_w, x_w.turn_w);
    out.gradient.angular += turn_n_m_per_rad * x_w.turn_w;
    for (std::size_t i = 3; i < 6; ++i) out.hessian(i, i) += turn_n_m_per_rad;
    return out;
  }

  /// Calls take(mark, its reading at x) for every sample that is inside at x. Readings of the others bound their depths
  /// at the next place: the steps of an iteration become short, and few are read again.   @pre covers(x_w)
  template <class Take>
  void for_each_inside(const motion& x_w, posed_samples& samples, Take&& take) noexcept {
    const double far_m = samples.steepest() * distance_m(x_w, bounded_at_w_, samples);
    bounded_at_w_ = x_w;
    for (mark& m : marks_) {
      m.depth_m += far_m;
      if (m.depth_m <= 0.0) continue;
      m.depth_m = samples.depth(m, x_w);
      if (m.depth_m <= 0.0) continue;
      const coarse_reading d = samples.read(m, x_w);
      if (d.value_m > 0.0) take(m, d);
    }
  }

  [[nodiscard]] bool covers(const motion& x_w, const posed_samples& samples) const noexcept {
    return gathered_ && distance_m(x_w, place_w_, samples) <= reach_m_;
  }
  void gather(const motion& x_w, posed_samples& samples) noexcept {
    // A caller that gathers again is on the move: a larger reach makes the next time come later.
    reach_m_ = gathered_ ? std::min(2.0 * reach_m_, longest_reach_m) : reach_m;
    place_w_ = bounded_at_w_ = x_w;
    gathered_ = true;
    // Where more are near than fit, only the nearest are kept: a bed that lacks samples is softer.
    for (bool fits = false; !fits;) {
      fits = true;
      marks_.clear();
      double above_m = -samples.steepest() * reach_m_;
      samples.walk(x_w, above_m, [&](const mark& m) noexcept {
        fits = marks_.size() < marks_.capacity();
        if (fits) {
          marks_.push_back(m);
        } else {
          above_m = std::numeric_limits<double>::infinity();  // ends the walk
        }
      });
      if (fits) break;
      reach_m_ *= 0.5;
      crowded = reach_m_ < least_reach_m;
      fits = crowded;
    }
  }
  [[nodiscard]] std::size_t size() const noexcept { return marks_.size(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(marks_); }

  /// How far from where samples were gathered the sum is right: several steps of a Newton iteration. Doubled each time.
  static constexpr double reach_m = 40e-6, longest_reach_m = 0.32e-3, least_reach_m = 2e-6;
  bool crowded = false;  ///< samples were left out at the last gathering

 private:
  // No sample moves further from y to x.
  [[nodiscard]] static double distance_m(const motion& x, const motion& y, const posed_samples& samples) noexcept {
    return glm::length(x.shift_w - y.shift_w) +
           (samples.longest_lever_m() + glm::length(x.shift_w)) * glm::length(x.turn_w - y.turn_w);
  }

  std::vector<mark> marks_;  // none is deeper than its depth_m at bounded_at_w_
  motion place_w_, bounded_at_w_;
  double reach_m_ = reach_m;
  bool gathered_ = false;
};

}  // namespace asperity::exits
