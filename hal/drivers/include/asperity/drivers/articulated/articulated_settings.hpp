// Settings of an arm, and the capabilities that follow from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/drivers/articulated/chain_inertia.hpp"
#include "asperity/drivers/articulated/joint_torques.hpp"
#include "asperity/drivers/joint/bus_service.hpp"
#include "asperity/drivers/joint/joint_drive.hpp"
#include "asperity/transport/io_clock.hpp"

namespace asperity {

/// A bus with drives on it. Both outlive the device.
struct arm_bus {
  can_bus* bus = nullptr;
  bus_service* service = nullptr;  ///< canopen_master for CANopen; null where the protocol needs none
};

/// A joint's motor. Angles and torques of drive and chain have the same sign and zero.
struct arm_joint {
  joint_drive* drive = nullptr;          ///< outlives the device
  std::size_t bus = 0;                   ///< which of the buses it is on
  double max_torque_n_m = 0.0;           ///< 0: what drive and chain allow; otherwise the least of the three
  double continuous_torque_n_m = 0.0;    ///< can be held for ever; 0: a third of the largest
  double max_speed_rad_per_s = 10.0;     ///< faster is a fault
  double reflected_inertia_kg_m2 = 0.0;  ///< of the rotor, seen from the joint
};

struct articulated_settings {
  std::string_view name = "articulated device";  ///< outlives the device
  driver_maturity maturity = driver_maturity::protocol_tested;
  serial_chain chain{};
  std::vector<arm_joint> joints{};  ///< one per joint of the chain, from the base outwards
  std::vector<arm_bus> buses{};
  io_clock* clock = nullptr;  ///< for open(), arm() and close() only; outlives the device

  std::int64_t period_ns = 1'000'000;          ///< of the application's ticks; what waits goes in the same steps
  std::int64_t reading_limit_ns = 10'000'000;  ///< age of a joint's reading that is a fault
  std::int64_t open_limit_ns = 20'000'000'000;
  std::int64_t arm_limit_ns = 5'000'000'000;

  bool gravity_compensation = true;
  std::int64_t gravity_ramp_ns = 500'000'000;  ///< compensation grows over this time after arm()
  soft_stop stop{};

  // What cannot be computed from the chain. A zero among the next four is replaced by a bound that holds in every pose;
  // who knows that the arm is used in a part of its workspace may state more, and joint limits still hold.
  double peak_force_n = 0.0;
  double peak_torque_n_m = 0.0;
  double moving_mass_kg = 0.0;
  double moving_inertia_kg_m2 = 0.0;
  joint_vector rest_rad{};  ///< angles in the middle of the workspace: the moving mass is taken there
  vec3 workspace_low_d{0.0};
  vec3 workspace_high_d{0.0};  ///< both zero: the box around all that the stretched arm could reach
  double rise_time_s = 0.005;  ///< in which the drives' torque goes from zero to its peak
  double max_stiffness_n_per_m = 0.0;
  double max_stiffness_n_m_per_rad = 0.0;
  double max_stiffness_rate_hz = 0.0;
};

/// Largest torque of a joint: the least of what drive, chain and configuration allow, N m.
[[nodiscard]] ASPERITY_API double torque_limit_n_m(const arm_joint& joint, const chain_joint& link) noexcept;

/// Whether an arm can be made of this: the error says which joint or bus is wrong, and how.
[[nodiscard]] ASPERITY_API result<void> check(const articulated_settings& c);

/// What the arm can do in every pose, from the chain taken as stretched out (bounds_of): half of what gravity leaves of
/// the torques is for a force, half for a torque, so that both peaks are possible at once in any direction.
/// The soft stops are not counted.
/// @pre check(c)
[[nodiscard]] ASPERITY_API device_capabilities capabilities_of(const articulated_settings& c) noexcept;

}  // namespace asperity
