// From the three legs of a Falcon to the position of its grip, and from a force to three torques.
//
// The grip hangs on three legs of which each turns an arm of length a about an axis on the base; a parallelogram of
// length b keeps the grip from turning. In the frame of a leg, turned by its angle phi about z, the grip is at (u, v,
// w). The end of the parallelogram lies at the distance R from the arm's end, as seen along v:
//   R = |(u + c - a cos theta, w - a sin theta)|,   (R - d - e)^2 + (v - s + f)^2 = b^2
// Source: R. E. Stamper, A Three Degree of Freedom Parallel Manipulator with Only Translational Degrees of Freedom, PhD
// thesis 97-4, University of Maryland, 1997; lengths as published for this device by libnifalcon. The formulas here are
// derived from the picture above.
//
// Frame d: origin in the middle of the base, z towards the person, y up, x to the right.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "asperity/core/math.hpp"

namespace asperity {

/// Angles of the three arms, rad.
using falcon_angles = std::array<double, 3>;

/// Rad of an arm per count of its encoder: wheels of 14.25 and 110 mm, 320 lines, four edges each.
inline constexpr double falcon_rad_per_count =
    0.01425 * 3.141592653589793 / (320.0 * 4.0) / (0.110 * 3.141592653589793 / 360.0) * 3.141592653589793 / 180.0;
inline constexpr double falcon_angle_at_zero_rad = 35.0 * 3.141592653589793 / 180.0;

/// @rt safe
[[nodiscard]] constexpr double falcon_angle_rad(std::int16_t encoder_counts) noexcept {
  return falcon_rad_per_count * encoder_counts + falcon_angle_at_zero_rad;
}

/// Where a Newton iteration ended.
struct falcon_position {
  vec3 grip_d{0.0, 0.0, 0.11};  ///< metres
  bool converged = false;       ///< false: grip_d means nothing
  int iterations = 0;
};

namespace falcon_detail {

inline constexpr double arm_m = 0.060;
inline constexpr double link_m = 0.1025;
inline constexpr double grip_offset_m = 0.01443;              // c
inline constexpr double joint_offsets_m = 0.01125 + 0.01125;  // d + e
inline constexpr double sideways_m = 0.02309 - 0.025;         // -s + f
inline constexpr double base_radius_m = 0.0400;               // r
inline constexpr std::array<double, 3> leg_cos = {-0.2588190451025207, 0.9659258262890683, -0.7071067811865476};
inline constexpr std::array<double, 3> leg_sin = {0.9659258262890683, -0.2588190451025207, -0.7071067811865476};

// One leg at a position: what its constraint misses, and its derivatives.
struct leg_state {
  double miss_m2 = 0.0;
  vec3 by_position{0.0};  // m
  double by_angle = 0.0;  // m^2 / rad
};

[[nodiscard]] inline leg_state look_at_leg(std::size_t i, const vec3& p, double angle) noexcept {
  const vec3 outwards{leg_cos[i], leg_sin[i], 0.0};
  const vec3 along{-leg_sin[i], leg_cos[i], 0.0};
  const double ca = std::cos(angle);
  const double sa = std::sin(angle);
  const double u = glm::dot(outwards, p) - base_radius_m + grip_offset_m - arm_m * ca;
  const double w = p.z - arm_m * sa;
  const double v = glm::dot(along, p) + sideways_m;
  const double reach = std::sqrt(u * u + w * w);
  const double over = reach - joint_offsets_m;
  leg_state leg;
  leg.miss_m2 = over * over + v * v - link_m * link_m;
  leg.by_position = 2.0 * (over / reach * (u * outwards + w * vec3(0.0, 0.0, 1.0)) + v * along);
  leg.by_angle = 2.0 * over / reach * arm_m * (u * sa - w * ca);
  return leg;
}

// x with sum of columns[i] * x[i] = b; nothing where the columns are nearly in a plane, or not finite.
[[nodiscard]] inline std::optional<vec3> solve_columns(const mat3& columns, const vec3& b) noexcept {
  const vec3 cross = glm::cross(columns[1], columns[2]);
  const double det = glm::dot(columns[0], cross);
  const double size = glm::length(columns[0]) * glm::length(columns[1]) * glm::length(columns[2]);
  if (!(std::fabs(det) > 1e-3 * size)) return std::nullopt;
  const vec3 x = vec3(glm::dot(b, cross), glm::dot(columns[0], glm::cross(b, columns[2])),
                      glm::dot(columns[0], glm::cross(columns[1], b))) /
                 det;
  if (!is_finite(x)) return std::nullopt;
  return x;
}

}  // namespace falcon_detail

/// Angles of the arms at a position of the grip; nothing where a leg does not reach it. Of the two angles that close a
/// leg it is the smaller one, as on the device.
/// @rt safe
[[nodiscard]] inline std::optional<falcon_angles> falcon_angles_at(const vec3& grip_d) noexcept {
  namespace d = falcon_detail;
  falcon_angles angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double u = d::leg_cos[i] * grip_d.x + d::leg_sin[i] * grip_d.y - d::base_radius_m + d::grip_offset_m;
    const double v = -d::leg_sin[i] * grip_d.x + d::leg_cos[i] * grip_d.y + d::sideways_m;
    const double w = grip_d.z;
    const double across2 = d::link_m * d::link_m - v * v;
    if (!(across2 >= 0.0)) return std::nullopt;
    const double reach = d::joint_offsets_m + std::sqrt(across2);
    // A triangle of arm, reach and the way to the arm's axis: the law of cosines.
    const double way2 = u * u + w * w;
    const double cosine = (way2 + d::arm_m * d::arm_m - reach * reach) / (2.0 * d::arm_m * std::sqrt(way2));
    if (!(cosine >= -1.0 && cosine <= 1.0)) return std::nullopt;
    angles[i] = std::atan2(w, u) - std::acos(cosine);
  }
  return angles;
}

/// Position of the grip at three angles, by Newton's method from `start_d`: at most 15 steps, of at most 20 mm each.
/// @rt safe: bounded
[[nodiscard]] inline falcon_position falcon_position_at(const falcon_angles& angles,
                                                        const vec3& start_d = {0.0, 0.0, 0.11}) noexcept {
  namespace d = falcon_detail;
  constexpr int most_steps = 15;
  constexpr double longest_step_m = 0.02;
  constexpr double close_enough_m = 1e-9;
  falcon_position found{.grip_d = start_d};
  for (const double angle : angles) {
    if (!std::isfinite(angle)) return found;
  }
  if (!is_finite(start_d)) return found;
  for (; found.iterations < most_steps; ++found.iterations) {
    mat3 transposed;
    vec3 miss;
    for (std::size_t i = 0; i < 3; ++i) {
      const d::leg_state leg = d::look_at_leg(i, found.grip_d, angles[i]);
      const int k = static_cast<int>(i);
      miss[k] = leg.miss_m2;
      for (int j = 0; j < 3; ++j) transposed[j][k] = leg.by_position[j];
    }
    const std::optional<vec3> step = d::solve_columns(transposed, -miss);
    if (!step) return found;
    const double length = glm::length(*step);
    found.grip_d += length > longest_step_m ? (longest_step_m / length) * *step : *step;
    if (length < close_enough_m) {
      found.converged = true;
      return found;
    }
  }
  return found;
}

/// Change of the three angles with the grip's position, rad/m: column i is the gradient of angle i, that is, row i of
/// the inverse Jacobian. Nothing where a leg is stretched out.
/// @rt safe
[[nodiscard]] inline std::optional<mat3> falcon_angle_gradients(const vec3& grip_d,
                                                                const falcon_angles& angles) noexcept {
  mat3 gradients;
  for (std::size_t i = 0; i < 3; ++i) {
    const falcon_detail::leg_state leg = falcon_detail::look_at_leg(i, grip_d, angles[i]);
    if (!(std::fabs(leg.by_angle) > 1e-6)) return std::nullopt;
    gradients[static_cast<int>(i)] = (-1.0 / leg.by_angle) * leg.by_position;
  }
  return gradients;
}

/// Torques of the arms (N m) that put `force_d` (N) on the hand: tau = J^T F. Nothing near a singular pose, and where
/// something is not finite.
/// @rt safe
[[nodiscard]] inline std::optional<vec3> falcon_torques(const vec3& grip_d, const falcon_angles& angles,
                                                        const vec3& force_d) noexcept {
  const std::optional<mat3> gradients = falcon_angle_gradients(grip_d, angles);
  if (!gradients) return std::nullopt;
  return falcon_detail::solve_columns(*gradients, force_d);
}

}  // namespace asperity
