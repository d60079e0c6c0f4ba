// The measure of a bristle: how far points that press are stretched along the surface, and how much of it friction holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/control/friction.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/render/support_plane.hpp"
#include "core/cholesky.hpp"

// The words are those of friction: z is a stretch, D a metric, theta the share of a stretch that is held.
namespace asperity::detail {

/// z^T D z. @rt safe
[[nodiscard]] inline double squared(const mat6& metric, const vec6& z) noexcept {
  return std::max(0.0, dot(z, metric * z));
}

/// Adds a point that presses with a share of the force: how its way along the surface follows from the motion.
/// @rt safe
inline void add_point(mat6& to, double share, const support_plane& p) noexcept {
  const vec3 u = any_orthogonal(p.n_ab_w), v = glm::cross(p.n_ab_w, u);
  // (T x) . u = u . (x.linear + x.angular x r) = u . x.linear + (r x u) . x.angular
  add_outer(to, share, {u, glm::cross(p.r_w, u)});
  add_outer(to, share, {v, glm::cross(p.r_w, v)});
  if (p.spread_m > 0.0) add_outer(to, share * p.spread_m * p.spread_m, {vec3(0.0), p.n_ab_w});
}

/// The shortest motion that stretches the points as z does. What stretches none of them, as rolling, would count when
/// others press. The metric has no inverse; a billionth of its size makes one, and takes less than 0.1 nm/s off z.
/// @rt safe
[[nodiscard]] inline vec6 without_rest(const mat6& metric, const vec6& z) noexcept {
  constexpr double of_its_size = 1e-9;
  const double linear = (metric(0, 0) + metric(1, 1) + metric(2, 2)) / 3.0;
  const double angular = (metric(3, 3) + metric(4, 4) + metric(5, 5)) / 3.0;
  mat6 regular = metric;
  for (std::size_t i = 0; i < 6; ++i) regular(i, i) += of_its_size * (i < 3 ? linear : angular + 1e-9 * linear);
  const cholesky6 factors(regular);
  return factors.positive() ? factors.solve(metric * z) : vec6{};
}

/// z in a new metric: shorter where it would store more than it did.
/// @rt safe
[[nodiscard]] inline vec6 held_in(const mat6& metric, const vec6& stretch, double stored_j,
                                  double stiffness_n_per_m) noexcept {
  const double held_j = 0.5 * stiffness_n_per_m * squared(metric, stretch);
  return held_j > stored_j ? std::sqrt(stored_j / held_j) * stretch : stretch;
}

/// theta of a step.
/// @param slide    velocity at the step's end against the body
/// @param theta    of the pass before, or the step before: what the bristle gave up there has slipped; the rest is its
///                 own stretch
/// @param normal_n force of the points
/// @rt safe
[[nodiscard]] inline double share_held(const friction_settings& s, const mat6& metric, const vec6& held,
                                       const vec6& slide, double h_s, double theta, double normal_n,
                                       double static_coefficient, double dynamic_coefficient) noexcept {
  const double slip_m_per_s = (1.0 - theta) * std::sqrt(squared(metric, held + h_s * slide)) / h_s;
  const double ratio = slip_m_per_s / s.stribeck_m_per_s;
  const double coefficient =
      dynamic_coefficient + (static_coefficient - dynamic_coefficient) * std::exp(-ratio * ratio);
  const double most_m = coefficient * normal_n / s.stiffness_n_per_m;
  const double stretch_m = std::sqrt(squared(metric, held + (h_s + s.damping_s) * slide));
  return stretch_m > most_m ? most_m / stretch_m : 1.0;
}

}  // namespace asperity::detail
