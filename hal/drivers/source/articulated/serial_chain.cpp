#include "asperity/drivers/articulated/serial_chain.hpp"

#include <cmath>
#include <cstddef>
#include <span>
#include <string>

namespace asperity {

chain_pose forward(const serial_chain& chain, const joint_vector& angles_rad) noexcept {
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

vec6 jacobian_column(const chain_pose& at, std::size_t i) noexcept {
  return {glm::cross(at.axis_d[i], at.T_dh.position - at.T_dl[i].position), at.axis_d[i]};
}

twist handle_velocity(const serial_chain& chain, const chain_pose& at, const joint_vector& rates_rad_per_s) noexcept {
  vec6 v;
  for (std::size_t i = 0; i < chain.joints.size(); ++i) v += rates_rad_per_s[i] * jacobian_column(at, i);
  return to_twist(v);
}

joint_vector torques_for(const serial_chain& chain, const chain_pose& at, const wrench& on_hand_d) noexcept {
  joint_vector out{};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) out[i] = dot(jacobian_column(at, i), to_vec6(on_hand_d));
  return out;
}

joint_vector torques_against_gravity(const serial_chain& chain, const chain_pose& at) noexcept {
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

void link_mass::add(const link_mass& other, const pose& T) noexcept {
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

result<void> check(const serial_chain& chain) {
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

result<serial_chain> chain_from_dh(std::span<const dh_row> rows, dh_convention convention, const pose& T_d0,
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
