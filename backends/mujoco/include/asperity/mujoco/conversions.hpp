// Poses and velocities between MuJoCo's arrays and ours. MuJoCo's quaternions are w x y z; ours are x y z w in files and arrays.
#pragma once

#include <span>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity::mujoco {

/// A vector from three numbers of an array of MuJoCo's. @rt safe
[[nodiscard]] inline vec3 vector_from_mujoco(std::span<const double, 3> xyz) noexcept {
  return {xyz[0], xyz[1], xyz[2]};
}

/// A quaternion from w x y z (xquat, body_quat, geom_quat, iquat). @rt safe
[[nodiscard]] inline quat quat_from_mujoco(std::span<const double, 4> wxyz) noexcept {
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

/// The other way round. @rt safe
inline void quat_to_mujoco(const quat& q, std::span<double, 4> wxyz) noexcept {
  wxyz[0] = q.w;
  wxyz[1] = q.x;
  wxyz[2] = q.y;
  wxyz[3] = q.z;
}

/// A pose from a position and w x y z (xpos and xquat, geom_pos and geom_quat). @rt safe
[[nodiscard]] inline pose pose_from_mujoco(std::span<const double, 3> xyz, std::span<const double, 4> wxyz) noexcept {
  return {quat_from_mujoco(wxyz), vector_from_mujoco(xyz)};
}

/// A pose from a free joint's seven numbers in qpos: x y z, w x y z. @rt safe
[[nodiscard]] inline pose pose_from_qpos(std::span<const double, 7> qpos) noexcept {
  return pose_from_mujoco(qpos.first<3>(), qpos.last<4>());
}

/// The other way round. @rt safe
inline void pose_to_qpos(const pose& T, std::span<double, 7> qpos) noexcept {
  qpos[0] = T.position.x;
  qpos[1] = T.position.y;
  qpos[2] = T.position.z;
  quat_to_mujoco(T.rotation, qpos.last<4>());
}

/// The velocity of a free body's frame, world axes, from its six numbers in qvel: MuJoCo keeps the linear velocity in world
/// axes and the angular velocity in the body's. @rt safe
[[nodiscard]] inline twist twist_from_qvel(const quat& R_wb, std::span<const double, 6> qvel) noexcept {
  return {vector_from_mujoco(qvel.first<3>()), R_wb * vector_from_mujoco(qvel.last<3>())};
}

/// The other way round. @rt safe
inline void twist_to_qvel(const quat& R_wb, const twist& velocity_w, std::span<double, 6> qvel) noexcept {
  const vec3 turn_b = glm::conjugate(R_wb) * velocity_w.angular;
  for (int i = 0; i < 3; ++i) {
    qvel[static_cast<std::size_t>(i)] = velocity_w.linear[i];
    qvel[static_cast<std::size_t>(i) + 3] = turn_b[i];
  }
}

/// A wrench from six numbers of xfrc_applied: force and torque about the body's centre of mass (xipos), world axes. @rt safe
[[nodiscard]] inline wrench wrench_from_xfrc(std::span<const double, 6> xfrc) noexcept {
  return {vector_from_mujoco(xfrc.first<3>()), vector_from_mujoco(xfrc.last<3>())};
}

}  // namespace asperity::mujoco
