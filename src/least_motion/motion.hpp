// A motion of the probe that a way out makes: a translation of a pivot, and a turn about it.
#pragma once

#include "asperity/core/math.hpp"

namespace asperity::exits {

/// Takes a point r from the probe's centre of mass to r + shift_w + turn_w x (r - pivot): linear in both, so that
/// sums over samples have simple derivatives. World axes; the pivot belongs to the pose, see pivot.hpp.
struct motion {
  vec3 shift_w{0.0};  ///< of the pivot, m
  vec3 turn_w{0.0};   ///< rad

  motion() = default;
  /// A translation is a motion without a turn.
  motion(const vec3& shift) noexcept : shift_w(shift) {}  // NOLINT(google-explicit-constructor)
  motion(const vec3& shift, const vec3& turn) noexcept : shift_w(shift), turn_w(turn) {}
};

}  // namespace asperity::exits
