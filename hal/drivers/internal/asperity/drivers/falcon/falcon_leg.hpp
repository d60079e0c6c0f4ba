// One leg of a Falcon: its lengths, and what its constraint misses at a position of the grip.
//
// The grip hangs on three legs of which each turns an arm of length a about an axis on the base; a parallelogram of
// length b keeps the grip from turning. In the frame of a leg, turned by its angle phi about z, the grip is at (u, v,
// w). The end of the parallelogram lies at the distance R from the arm's end, as seen along v:
//   R = |(u + c - a cos theta, w - a sin theta)|,   (R - d - e)^2 + (v - s + f)^2 = b^2
// Source: R. E. Stamper, A Three Degree of Freedom Parallel Manipulator with Only Translational Degrees of Freedom, PhD
// thesis 97-4, University of Maryland, 1997; lengths as published for this device by libnifalcon. The formulas here are
// derived from the picture above.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "asperity/core/math.hpp"

namespace asperity::falcon_detail {

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

}  // namespace asperity::falcon_detail
