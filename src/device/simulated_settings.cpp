#include "asperity/device/simulated/simulated_settings.hpp"

namespace asperity {

hand_settings soft_hand() noexcept {
  return {.stiffness_n_per_m = 150.0,
          .damping_n_s_per_m = 2.0,
          .stiffness_n_m_per_rad = 0.6,
          .damping_n_m_s_per_rad = 0.006,
          .tremor_m = 2e-5};
}

hand_settings firm_hand() noexcept {
  return {.stiffness_n_per_m = 1200.0,
          .damping_n_s_per_m = 10.0,
          .stiffness_n_m_per_rad = 5.0,
          .damping_n_m_s_per_rad = 0.05,
          .tremor_m = 5e-5};
}

device_capabilities simulated_capabilities() noexcept {
  return {.name = "simulated",
          .maturity = driver_maturity::simulated,
          .sensed = all_axes,
          .actuated = all_axes,
          .continuous_force_n = 8.0,
          .peak_force_n = 20.0,
          .continuous_torque_n_m = 0.5,
          .peak_torque_n_m = 1.0,
          .force_slew_n_per_s = 5000.0,
          .torque_slew_n_m_per_s = 250.0,
          .max_stiffness_n_per_m = 3000.0,
          .max_stiffness_n_m_per_rad = 10.0,
          .max_stiffness_rate_hz = 1000.0,
          .workspace_low_d = {-0.2, -0.2, -0.2},
          .workspace_high_d = {0.2, 0.2, 0.2},
          .position_resolution_m = 1e-6,
          .rotation_resolution_rad = 1e-5,
          .nominal_rate_hz = 1000.0,
          .minimum_rate_hz = 100.0,
          .worst_latency_ns = 20'000'000,
          .moving_mass_kg = 0.15,
          .moving_inertia_kg_m2 = 2e-4,
          .needs_homing = false,
          .device_side_watchdog = true};
}

}  // namespace asperity
