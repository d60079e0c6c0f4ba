#include "asperity/drivers/articulated/joint_torques.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace asperity {

double with_stop(double own_n_m, const soft_stop& stop, const chain_joint& joint, double angle_rad,
                 double rate_rad_per_s) noexcept {
  const double over = angle_rad - (joint.upper_rad - stop.zone_rad);
  const double under = (joint.lower_rad + stop.zone_rad) - angle_rad;
  const double outwards = stop.damping_n_m_s_per_rad;
  if (over > 0.0) own_n_m -= stop.stiffness_n_m_per_rad * over + outwards * std::max(0.0, rate_rad_per_s);
  if (under > 0.0) own_n_m += stop.stiffness_n_m_per_rad * under + outwards * std::max(0.0, -rate_rad_per_s);
  return own_n_m;
}

shared_torques share_torques(std::size_t joints, const joint_vector& own_n_m, const joint_vector& wanted_n_m,
                             const joint_vector& limit_n_m) noexcept {
  shared_torques out;
  joint_vector own{};
  for (std::size_t i = 0; i < joints; ++i) {
    const double limit = limit_n_m[i];
    if (!std::isfinite(own_n_m[i]) || !std::isfinite(wanted_n_m[i]) || !(limit >= 0.0)) return {{}, 0.0, false};
    own[i] = std::clamp(own_n_m[i], -limit, limit);
    const double room = wanted_n_m[i] > 0.0 ? limit - own[i] : limit + own[i];
    if (std::fabs(wanted_n_m[i]) > room) out.scale = std::min(out.scale, room / std::fabs(wanted_n_m[i]));
  }
  for (std::size_t i = 0; i < joints; ++i) {
    // The clamp takes off what rounding puts on.
    out.torque_n_m[i] = std::clamp(own[i] + out.scale * wanted_n_m[i], -limit_n_m[i], limit_n_m[i]);
  }
  return out;
}

wrench_room room_for_wrench(const serial_chain& chain, const chain_pose& at, const joint_vector& own_n_m,
                            const joint_vector& limit_n_m) noexcept {
  constexpr double unbounded = std::numeric_limits<double>::infinity();
  wrench_room out{unbounded, unbounded};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const double room = std::max(0.0, limit_n_m[i] - std::fabs(own_n_m[i]));
    const double lever = glm::length(jacobian_column(at, i).linear);
    if (lever > 0.0) out.force_n = std::min(out.force_n, room / lever);
    out.torque_n_m = std::min(out.torque_n_m, room);
  }
  return out;
}

chain_bounds bounds_of(const serial_chain& chain) noexcept {
  chain_bounds b;
  const std::size_t n = chain.joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    double way = 0.0;  // from joint i to joint k, stretched
    double moment = 0.0;
    for (std::size_t k = i; k < n; ++k) {
      if (k > i) way += glm::length(chain.joints[k].T_parent.position);
      moment += chain.joints[k].link.mass_kg * (way + glm::length(chain.joints[k].link.centre));
    }
    b.lever_m[i] = way + glm::length(chain.T_handle.position);
    b.weight_n_m[i] = moment * glm::length(chain.gravity_d);
    if (i == 0) {
      const vec3 axis_d = chain.joints[0].T_parent.rotation * chain.joints[0].axis;
      b.weight_n_m[0] = moment * glm::length(glm::cross(axis_d, chain.gravity_d));
    }
  }
  b.reach_m = b.lever_m[0];
  return b;
}

}  // namespace asperity
