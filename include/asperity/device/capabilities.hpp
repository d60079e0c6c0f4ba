// What a device can do, in one table.
#pragma once

#include <cstdint>
#include <string_view>

#include "asperity/core/math.hpp"

namespace asperity {

/// How much of a driver has been seen to work. Nothing is called hardware_verified without the hardware.
enum class driver_maturity : std::uint8_t {
  simulated,          ///< there is no hardware behind it
  protocol_tested,    ///< tested against a peer that speaks the protocol
  hardware_verified,  ///< tested on the device itself
};

[[nodiscard]] constexpr const char* to_string(driver_maturity m) noexcept {
  switch (m) {
    case driver_maturity::simulated:
      return "simulated";
    case driver_maturity::protocol_tested:
      return "protocol tested";
    case driver_maturity::hardware_verified:
      return "hardware verified";
  }
  return "unknown maturity";
}

/// Set of axes: bits 0-2 translation x y z, bits 3-5 rotation x y z, in the device's base frame.
using axis_mask = std::uint8_t;
inline constexpr axis_mask no_axes = 0x00;
inline constexpr axis_mask translation_axes = 0x07;
inline constexpr axis_mask rotation_axes = 0x38;
inline constexpr axis_mask all_axes = 0x3f;

/// Properties of one device, SI. A number that is not known is zero, and a limit of zero allows nothing:
/// a driver has to state its limits before a single newton leaves.
struct device_capabilities {
  std::string_view name;  ///< outlives the device: a literal or a string that the driver owns
  driver_maturity maturity = driver_maturity::simulated;

  axis_mask sensed = no_axes;
  axis_mask actuated = no_axes;

  double continuous_force_n = 0.0;  ///< can be held for ever
  double peak_force_n = 0.0;        ///< can be reached for a short time
  double continuous_torque_n_m = 0.0;
  double peak_torque_n_m = 0.0;
  double force_slew_n_per_s = 0.0;  ///< fastest change of force that the device follows
  double torque_slew_n_m_per_s = 0.0;

  double max_stiffness_n_per_m = 0.0;      ///< largest stable stiffness ...
  double max_stiffness_n_m_per_rad = 0.0;  ///< ... in rotation
  double max_stiffness_rate_hz = 0.0;      ///< ... at this loop rate; it means nothing without it

  vec3 workspace_low_d{0.0};  ///< box of the handle's origin, base frame, metres
  vec3 workspace_high_d{0.0};
  double position_resolution_m = 0.0;
  double rotation_resolution_rad = 0.0;

  double nominal_rate_hz = 0.0;
  double minimum_rate_hz = 0.0;       ///< below it the device disarms itself or cannot be controlled
  std::int64_t worst_latency_ns = 0;  ///< from measurement to host
  double moving_mass_kg = 0.0;        ///< apparent mass at the handle; bounds the damping of the passivity guard
  double moving_inertia_kg_m2 = 0.0;
  bool needs_homing = false;
  bool device_side_watchdog = false;  ///< the device itself goes to zero when the host falls silent
  double gripper_low_m = 0.0;         ///< opening of the gripper when it is shut ...
  double gripper_high_m = 0.0;        ///< ... and wide open; equal: the device has no gripper

  [[nodiscard]] constexpr bool has_gripper() const noexcept { return gripper_high_m > gripper_low_m; }
};

}  // namespace asperity
