// The gyroscopic step of a body that tumbles.
#pragma once

#include "asperity/core/spatial.hpp"

namespace asperity::detail {

/// Angular velocity after h_s seconds without any torque, rad/s: I (w - w0) + h w x I w = 0 in the body's axes. Its energy is
/// that of w0 less half of (w - w0) I (w - w0).
/// @return w0 where that is not finite   @rt safe
[[nodiscard]] inline vec3 after_free_turn(const mat3& inertia, const vec3& w0, double h_s) noexcept {
  const auto cross_of = [](const vec3& x) {
    return mat3(vec3(0.0, x.z, -x.y), vec3(-x.z, 0.0, x.x), vec3(x.y, -x.x, 0.0));
  };
  vec3 w = w0;
  for (int i = 0; i < 3; ++i) {
    const vec3 momentum = inertia * w;
    const vec3 off = inertia * (w - w0) + h_s * glm::cross(w, momentum);
    const mat3 slope = inertia + h_s * (cross_of(w) * inertia - cross_of(momentum));
    w -= glm::inverse(slope) * off;
  }
  return is_finite(w) ? w : w0;
}

}  // namespace asperity::detail
