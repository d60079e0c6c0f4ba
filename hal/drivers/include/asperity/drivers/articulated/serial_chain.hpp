// An arm as a chain of joints: where its handle is, how it moves, and which torques hold its weight.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

inline constexpr std::size_t most_joints = 8;

/// One number per joint. Numbers beyond the chain's size are zero.
using joint_vector = std::array<double, most_joints>;

/// Mass of a link, as URDF states it.
struct ASPERITY_API link_mass {
  double mass_kg = 0.0;
  vec3 centre{0.0};         ///< centre of mass, link frame
  mat3 inertia_kg_m2{0.0};  ///< about the centre of mass, axes of the link frame

  /// Adds another body that is fixed to the same link. `T` is its frame in the link frame.
  void add(const link_mass& other, const pose& T) noexcept;
};

/// A joint that turns, and the link behind it. The link's frame is the joint's frame, turned by the joint's angle.
struct chain_joint {
  pose T_parent{};           ///< joint frame at angle 0 in the frame of the link before it (of the base: d)
  vec3 axis{0.0, 0.0, 1.0};  ///< unit, joint frame; positive angles turn right-handed about it
  double lower_rad = 0.0;    ///< least angle; lower_rad < upper_rad
  double upper_rad = 0.0;
  double max_torque_n_m = 0.0;  ///< of the mechanics; 0: not known
  link_mass link{};
};

/// Joints from the base to the handle. Turning joints only: a drive of torques moves no sliding joint.
struct serial_chain {
  fixed_vector<chain_joint, most_joints> joints{};
  pose T_handle{};                     ///< handle h in the frame of the last link
  vec3 gravity_d{0.0, 0.0, -9.80665};  ///< acceleration of a falling body, base frame, m/s^2
};

/// A chain at one set of angles, base frame d.
struct chain_pose {
  std::array<pose, most_joints> T_dl{};    ///< link frames
  std::array<vec3, most_joints> axis_d{};  ///< joint axes, unit
  pose T_dh{};                             ///< handle
};

/// Where everything is.
/// @rt safe
[[nodiscard]] ASPERITY_API chain_pose forward(const serial_chain& chain, const joint_vector& angles_rad) noexcept;

/// Column i of the Jacobian: velocity of the handle's origin for 1 rad/s of joint i, base frame.
/// @rt safe
[[nodiscard]] ASPERITY_API vec6 jacobian_column(const chain_pose& at, std::size_t i) noexcept;

/// Velocity of the handle's origin, base frame.
/// @rt safe
[[nodiscard]] ASPERITY_API twist handle_velocity(const serial_chain& chain, const chain_pose& at,
                                                 const joint_vector& rates_rad_per_s) noexcept;

/// Joint torques that put a wrench on the hand (axes of d, torque about the handle's origin): J^T w, N m.
/// @rt safe
[[nodiscard]] ASPERITY_API joint_vector torques_for(const serial_chain& chain, const chain_pose& at,
                                                    const wrench& on_hand_d) noexcept;

/// Joint torques that hold the links against gravity, N m.
/// @rt safe
[[nodiscard]] ASPERITY_API joint_vector torques_against_gravity(const serial_chain& chain,
                                                                const chain_pose& at) noexcept;

/// One row of a table of Denavit and Hartenberg.
struct dh_row {
  double a_m = 0.0;
  double alpha_rad = 0.0;
  double d_m = 0.0;
  double theta_rad = 0.0;  ///< added to the joint's angle
  double lower_rad = -3.141592653589793;
  double upper_rad = 3.141592653589793;
  double max_torque_n_m = 0.0;
  link_mass link{};  ///< in the frame that the row ends in
};

enum class dh_convention : std::uint8_t {
  classic,   ///< row i: Rz(theta) Tz(d) Tx(a) Rx(alpha); the joint turns about z of the frame before the row
  modified,  ///< row i: Rx(alpha) Tx(a) Rz(theta) Tz(d); the joint turns about z of the frame that the row ends in
};

/// Whether the chain can be computed with: at least one joint, every number finite, axes and quaternions of unit
/// length, angles in order, no negative mass. The error names the joint, counted from 1.
[[nodiscard]] ASPERITY_API result<void> check(const serial_chain& chain);

/// A chain from a table.
/// @param T_d0 frame 0 of the table in the device's base frame
/// @param T_nh handle in the last frame of the table
[[nodiscard]] ASPERITY_API result<serial_chain> chain_from_dh(std::span<const dh_row> rows, dh_convention convention,
                                                              const pose& T_d0 = {}, const pose& T_nh = {});

}  // namespace asperity
