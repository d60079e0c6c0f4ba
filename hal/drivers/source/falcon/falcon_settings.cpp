#include "asperity/drivers/falcon/falcon_settings.hpp"

namespace asperity {

device_capabilities falcon_capabilities() noexcept {
  return {.name = "novint falcon",
          .maturity = driver_maturity::protocol_tested,
          .sensed = translation_axes,
          .actuated = translation_axes,
          .continuous_force_n = 2.0,
          .peak_force_n = 4.0,
          .force_slew_n_per_s = 1000.0,
          .max_stiffness_n_per_m = 1000.0,
          .max_stiffness_rate_hz = 1000.0,
          .workspace_low_d = {-0.035, -0.035, 0.085},
          .workspace_high_d = {0.035, 0.035, 0.155},
          .position_resolution_m = 1e-4,
          .nominal_rate_hz = 1000.0,
          .minimum_rate_hz = 500.0,
          .worst_latency_ns = 3'000'000,
          .needs_homing = true,
          .device_side_watchdog = false};
}

}  // namespace asperity
