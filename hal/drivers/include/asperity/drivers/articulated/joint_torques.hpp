// From a wrench to joint torques within every joint's limit.
#pragma once

#include <cstddef>

#include "asperity/core/export.hpp"
#include "asperity/drivers/articulated/serial_chain.hpp"

namespace asperity {

/// A stop made of torque, before the mechanical one.
struct soft_stop {
  double zone_rad = 0.05;               ///< begins that much before the chain's limit
  double stiffness_n_m_per_rad = 20.0;  ///< pushes back from there on; never pulls
  double damping_n_m_s_per_rad = 0.2;   ///< while the joint goes on outwards
  double overrun_rad = 0.1;             ///< so far beyond the limit no joint can be: a fault
};

/// A joint's own torque with what its stop pushes, N m.
/// @rt safe
[[nodiscard]] ASPERITY_API double with_stop(double own_n_m, const soft_stop& stop, const chain_joint& joint,
                                            double angle_rad, double rate_rad_per_s) noexcept;

/// Torques that are commanded to the joints.
struct shared_torques {
  joint_vector torque_n_m{};
  double scale = 1.0;  ///< factor on the wrench, the same for every joint: its direction is kept
  bool finite = true;  ///< false: something was NaN or infinite, and all torques are zero
};

/// own + scale * wanted with the largest scale up to 1 at which no joint is over its limit. A joint whose own torque
/// alone is over its limit puts out the limit, and nothing of the wrench that would add to it.
/// @param own_n_m torques that do not belong to the wrench: against gravity, of the stops
/// @param wanted_n_m J^T w
/// @param limit_n_m at least 0
/// @rt safe
[[nodiscard]] ASPERITY_API shared_torques share_torques(std::size_t joints, const joint_vector& own_n_m,
                                                        const joint_vector& wanted_n_m,
                                                        const joint_vector& limit_n_m) noexcept;

/// Largest wrench that can be put out whatever its direction.
struct wrench_room {
  double force_n = 0.0;     ///< without torque; infinite where no joint moves the handle's origin
  double torque_n_m = 0.0;  ///< without force
};

/// In the present pose, beside the joints' own torques. 0 where a joint has nothing left.
/// @rt safe
[[nodiscard]] ASPERITY_API wrench_room room_for_wrench(const serial_chain& chain, const chain_pose& at,
                                                       const joint_vector& own_n_m,
                                                       const joint_vector& limit_n_m) noexcept;

/// Bounds that hold at all angles.
struct chain_bounds {
  joint_vector lever_m{};     ///< distance of the handle from the joint, at most
  joint_vector weight_n_m{};  ///< torque against gravity, at most
  double reach_m = 0.0;       ///< of the handle from the first joint
};
/// Every link is taken as stretched out. The first joint's axis stands still: of the weight it bears what is at right
/// angles to gravity only, so that a vertical axis bears none.
[[nodiscard]] ASPERITY_API chain_bounds bounds_of(const serial_chain& chain) noexcept;

}  // namespace asperity
