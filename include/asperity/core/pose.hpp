// Poses and their names. T_ab maps coordinates in frame b to coordinates in frame a.
#pragma once

#include <array>

#include "asperity/core/math.hpp"

namespace asperity {

/// Rigid transform, rotation then translation; T_ab maps a point given in b to the same point given in a. Metres.
/// @pre rotation has unit length where a function does not say that it checks
struct pose {
  quat rotation{1.0, 0.0, 0.0, 0.0};  ///< GLM's constructor order: w x y z
  vec3 position{0.0};                 ///< origin of b in a, metres

  /// The point p_b in frame a.
  [[nodiscard]] vec3 operator*(const vec3& p_b) const noexcept { return rotation * p_b + position; }

  /// T_ab * T_bc = T_ac.
  [[nodiscard]] pose operator*(const pose& T_bc) const noexcept {
    return {rotation * T_bc.rotation, rotation * T_bc.position + position};
  }
};

/// T_ba of T_ab.
/// @rt safe
[[nodiscard]] inline pose inverse(const pose& T_ab) noexcept {
  const quat r = glm::conjugate(T_ab.rotation);
  return {r, -(r * T_ab.position)};
}

/// Quaternion from four numbers in the order x y z w (ROS, glTF, our command line and files).
/// @rt safe
[[nodiscard]] inline quat quat_from_xyzw(const std::array<double, 4>& q) noexcept { return {q[3], q[0], q[1], q[2]}; }

/// Quaternion from four numbers in the order w x y z (MuJoCo, Eigen's and GLM's constructors).
/// @rt safe
[[nodiscard]] inline quat quat_from_wxyz(const std::array<double, 4>& q) noexcept { return {q[0], q[1], q[2], q[3]}; }

/// The four numbers of a quaternion in the order x y z w.
/// @rt safe
[[nodiscard]] inline std::array<double, 4> to_xyzw(const quat& q) noexcept { return {q.x, q.y, q.z, q.w}; }

/// True where every number is finite and the quaternion's length is 1 within 1e-6.
/// A pose from outside (device, file, command line) passes this before it is used.
/// @rt safe
[[nodiscard]] inline bool is_valid(const pose& T) noexcept {
  const quat& q = T.rotation;
  const double n2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return is_finite(T.position) && std::fabs(n2 - 1.0) <= 2e-6;  // a NaN fails the comparison
}

}  // namespace asperity
