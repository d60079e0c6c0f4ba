// From a force on the hand to the three numbers that are sent to a Falcon's motors.
#pragma once

#include <array>
#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/drivers/falcon/falcon_frame.hpp"
#include "asperity/drivers/falcon/falcon_kinematics.hpp"

namespace asperity {

/// Counts per N m of an arm, with the sign of the published drivers. Nobody has published a measurement: the number is
/// the one that those drivers use, and its authors call it a guess. A commanded newton can be more or less than a
/// newton on the hand, by an unknown factor.
inline constexpr double falcon_counts_per_n_m = -1e4;

/// Counts of the three motors for a force on the hand (N, frame d). Where a motor would have to give more than
/// `limit_counts` all three are scaled, so that the force keeps its direction. Zero where the pose is singular and
/// where anything is not finite.
/// @rt safe
[[nodiscard]] ASPERITY_API std::array<std::int16_t, 3> falcon_counts_for(
    const vec3& grip_d, const falcon_angles& angles, const vec3& force_d,
    std::int16_t limit_counts = falcon_counts_limit) noexcept;

}  // namespace asperity
