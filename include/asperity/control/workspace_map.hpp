// From the device's handle to the probe, and back from the probe's wrench to the hand.
#pragma once

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// Where the device's workspace lies in the world: p_w = T_wd * (scale * p_d). The default is the identity.
/// The handle frame h carries the probe's body frame a at T_ha. Rotations are not scaled.
/// The map is a lossless transformer: the power F . v + T . w is the same on both sides, so a passive probe is a
/// passive device. A scale of 2 doubles motions in the world, and doubles the force on the hand.
struct workspace_map {
  pose T_wd{};
  double scale = 1.0;  ///< > 0, metres in the world for a metre of the device
  pose T_ha{};

  /// Pose of the handle in the world.
  /// @rt safe
  [[nodiscard]] pose to_world(const pose& T_dh) const noexcept {
    return {T_wd.rotation * T_dh.rotation, T_wd * (scale * T_dh.position)};
  }

  /// Velocity of the handle's origin in the world.
  /// @rt safe
  [[nodiscard]] twist to_world(const twist& velocity_d) const noexcept {
    return {T_wd.rotation * (scale * velocity_d.linear), T_wd.rotation * velocity_d.angular};
  }

  /// Wrench on the hand: axes of d, torque about the handle's origin, from one in world axes about point_w.
  /// @param handle_w origin of the handle in the world, as to_world() gives it
  /// @rt safe
  [[nodiscard]] wrench to_device(const wrench& on_hand_w, const vec3& point_w, const vec3& handle_w) const noexcept {
    const wrench about_handle = transport(on_hand_w, point_w, handle_w);
    const quat r_dw = glm::conjugate(T_wd.rotation);
    return {r_dw * (scale * about_handle.force), r_dw * about_handle.torque};
  }
};

}  // namespace asperity
