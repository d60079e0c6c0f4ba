// An arm as a chain of joints: where its handle is, how it moves, and what its weight asks of the joints.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

inline constexpr std::size_t most_joints = 8;

/// One number per joint. What stands behind the chain's size is zero.
using joint_vector = std::array<double, most_joints>;

/// Mass of a link, as URDF states it.
struct link_mass {
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

/// Joints from the base to the handle. Turning joints only: a sliding one is none that a drive of torques moves.
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
[[nodiscard]] inline chain_pose forward(const serial_chain& chain, const joint_vector& angles_rad) noexcept {
  chain_pose out;
  pose T{};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const chain_joint& j = chain.joints[i];
    T = T * j.T_parent;
    T.rotation = glm::normalize(T.rotation * exp_rotation(angles_rad[i] * j.axis));
    out.T_dl[i] = T;
    out.axis_d[i] = T.rotation * j.axis;
  }
  out.T_dh = T * chain.T_handle;
  out.T_dh.rotation = glm::normalize(out.T_dh.rotation);
  return out;
}

/// Column i of the Jacobian: velocity of the handle's origin for 1 rad/s of joint i, base frame.
/// @rt safe
[[nodiscard]] inline vec6 jacobian_column(const chain_pose& at, std::size_t i) noexcept {
  return {glm::cross(at.axis_d[i], at.T_dh.position - at.T_dl[i].position), at.axis_d[i]};
}

/// Velocity of the handle's origin, base frame.
/// @rt safe
[[nodiscard]] inline twist handle_velocity(const serial_chain& chain, const chain_pose& at,
                                           const joint_vector& rates_rad_per_s) noexcept {
  vec6 v;
  for (std::size_t i = 0; i < chain.joints.size(); ++i) v += rates_rad_per_s[i] * jacobian_column(at, i);
  return to_twist(v);
}

/// Joint torques that put a wrench on the hand (axes of d, torque about the handle's origin): J^T w, N m.
/// @rt safe
[[nodiscard]] inline joint_vector torques_for(const serial_chain& chain, const chain_pose& at,
                                              const wrench& on_hand_d) noexcept {
  joint_vector out{};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) out[i] = dot(jacobian_column(at, i), to_vec6(on_hand_d));
  return out;
}

/// Joint torques that hold the links against gravity, N m.
/// @rt safe
[[nodiscard]] inline joint_vector torques_against_gravity(const serial_chain& chain, const chain_pose& at) noexcept {
  joint_vector out{};
  // From the last link inwards: what hangs on a joint is one mass at one place.
  double mass = 0.0;
  vec3 moment_d{0.0};  // sum of mass times place
  for (std::size_t i = chain.joints.size(); i-- > 0;) {
    const link_mass& l = chain.joints[i].link;
    mass += l.mass_kg;
    moment_d += l.mass_kg * (at.T_dl[i] * l.centre);
    const vec3 arm_d = moment_d - mass * at.T_dl[i].position;
    out[i] = -glm::dot(at.axis_d[i], glm::cross(arm_d, chain.gravity_d));
  }
  return out;
}

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
[[nodiscard]] result<void> check(const serial_chain& chain);

/// A chain from a table.
/// @param T_d0 frame 0 of the table in the device's base frame
/// @param T_nh handle in the last frame of the table
[[nodiscard]] result<serial_chain> chain_from_dh(std::span<const dh_row> rows, dh_convention convention,
                                                 const pose& T_d0 = {}, const pose& T_nh = {});

inline void link_mass::add(const link_mass& other, const pose& T) noexcept {
  const double sum = mass_kg + other.mass_kg;
  if (!(other.mass_kg > 0.0) || !(sum > 0.0)) return;
  const mat3 r = glm::mat3_cast(T.rotation);
  const vec3 there = T * other.centre;
  const vec3 both = (mass_kg * centre + other.mass_kg * there) / sum;
  const auto moved = [](double m, const vec3& by) {
    const mat3 s = skew(by);
    return -m * (s * s);
  };
  inertia_kg_m2 = inertia_kg_m2 + moved(mass_kg, centre - both) + r * other.inertia_kg_m2 * glm::transpose(r) +
                  moved(other.mass_kg, there - both);
  mass_kg = sum;
  centre = both;
}

inline result<void> check(const serial_chain& chain) {
  const auto unit = [](const vec3& v) { return std::fabs(glm::dot(v, v) - 1.0) <= 1e-6; };
  const auto wrong = [](std::size_t i, const char* what) {
    return error{error_code::invalid_argument, "joint " + std::to_string(i + 1) + " of the chain: " + what};
  };
  if (chain.joints.empty()) return error{error_code::invalid_argument, "the chain has no joint"};
  if (chain.joints.dropped() > 0) {
    return error{error_code::limit_exceeded,
                 "the chain has more than " + std::to_string(most_joints) + " joints, which is the most there can be"};
  }
  if (!is_valid(chain.T_handle) || !is_finite(chain.gravity_d)) {
    return error{error_code::invalid_argument,
                 "the handle's pose or the gravity of the chain is not finite, or the quaternion not of unit length"};
  }
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const chain_joint& j = chain.joints[i];
    if (!is_valid(j.T_parent)) return wrong(i, "its pose is not finite, or its quaternion not of unit length");
    if (!unit(j.axis)) return wrong(i, "its axis is not of unit length");
    if (!(j.lower_rad < j.upper_rad) || !std::isfinite(j.lower_rad) || !std::isfinite(j.upper_rad)) {
      return wrong(i, "its limits are not finite angles in rising order; an arm's joint has to have limits");
    }
    if (!(j.max_torque_n_m >= 0.0) || !std::isfinite(j.max_torque_n_m)) return wrong(i, "its torque limit is negative");
    if (!(j.link.mass_kg >= 0.0) || !std::isfinite(j.link.mass_kg) || !is_finite(j.link.centre)) {
      return wrong(i, "the mass of its link is negative, or its centre not finite");
    }
  }
  return {};
}

inline result<serial_chain> chain_from_dh(std::span<const dh_row> rows, dh_convention convention, const pose& T_d0,
                                          const pose& T_nh) {
  const auto about_z = [](double angle, double along) {
    return pose{exp_rotation({0.0, 0.0, angle}), {0.0, 0.0, along}};
  };
  const auto about_x = [](double angle, double along) {
    return pose{exp_rotation({angle, 0.0, 0.0}), {along, 0.0, 0.0}};
  };
  serial_chain chain;
  pose T = T_d0;  // from the last joint's frame to the next one's
  for (const dh_row& row : rows) {
    chain_joint j;
    pose to_link_frame{};  // the row's last frame, in which the mass is given, in the frame of our link
    if (convention == dh_convention::classic) {
      j.T_parent = T;
      to_link_frame = about_z(row.theta_rad, row.d_m) * about_x(row.alpha_rad, row.a_m);
      T = to_link_frame;
    } else {
      j.T_parent = T * about_x(row.alpha_rad, row.a_m) * about_z(row.theta_rad, row.d_m);
      T = {};
    }
    j.lower_rad = row.lower_rad;
    j.upper_rad = row.upper_rad;
    j.max_torque_n_m = row.max_torque_n_m;
    j.link.add(row.link, to_link_frame);
    static_cast<void>(chain.joints.push_back(j));
  }
  chain.T_handle = T * T_nh;
  if (result<void> good = check(chain); !good) return good.error();
  return chain;
}

}  // namespace asperity
