// From the three legs of a Falcon to the position of its grip, and from a force to three torques.
//
// Frame d: origin in the middle of the base, z towards the person, y up, x to the right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "asperity/core/export.hpp"
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

/// Angles of the arms at a position of the grip; nothing where a leg does not reach it. Of the two angles that close a
/// leg it is the smaller one, as on the device.
/// @rt safe
[[nodiscard]] ASPERITY_API std::optional<falcon_angles> falcon_angles_at(const vec3& grip_d) noexcept;

/// Position of the grip at three angles, by Newton's method from `start_d`: at most 15 steps, of at most 20 mm each.
/// @rt safe: bounded
[[nodiscard]] ASPERITY_API falcon_position falcon_position_at(const falcon_angles& angles,
                                                              const vec3& start_d = {0.0, 0.0, 0.11}) noexcept;

/// Change of the three angles with the grip's position, rad/m: column i is the gradient of angle i, that is, row i of
/// the inverse Jacobian. Nothing where a leg is stretched out.
/// @rt safe
[[nodiscard]] ASPERITY_API std::optional<mat3> falcon_angle_gradients(const vec3& grip_d,
                                                                      const falcon_angles& angles) noexcept;

/// Torques of the arms (N m) that put `force_d` (N) on the hand: tau = J^T F. Nothing near a singular pose, and where
/// something is not finite.
/// @rt safe
[[nodiscard]] ASPERITY_API std::optional<vec3> falcon_torques(const vec3& grip_d, const falcon_angles& angles,
                                                              const vec3& force_d) noexcept;

}  // namespace asperity
