// Settings of a device loop.
#pragma once

#include <cstdint>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/control/passivity_guard.hpp"
#include "asperity/control/probe.hpp"
#include "asperity/control/rate_monitor.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/control/workspace_map.hpp"
#include "asperity/device/output_gate.hpp"
#include "asperity/device/sample_check.hpp"

namespace asperity {

/// Settings of the device loop. The defaults are those of science, section 8.
struct control_settings {
  probe_settings probe{};
  coupling_settings coupling{};
  contact_law contact{};  ///< of support planes, see check(); a linear contact brings its own stiffness
  guard_settings guard{};
  contact_ageing ageing{};  ///< how old a contact may be felt
  rate_limits rates{};      ///< how late the loops may be
  workspace_map map{};
  sample_check_settings samples{};
  gate_limits limits{.peak_force_n = 1e6,
                     .continuous_force_n = 1e6,
                     .force_slew_n_per_s = 1e6,
                     .peak_torque_n_m = 1e6,
                     .continuous_torque_n_m = 1e6,
                     .torque_slew_n_m_per_s = 1e6};  ///< the application's; the device's own apply where they are lower
  double low_pass_hz = output_gate::no_low_pass;     ///< cut-off of the gate's low-pass on the wrench; infinite: none
  /// Silence of the application after which the gate shuts (watchdog); 0: no watchdog. See exchange::application.
  std::int64_t watchdog_ns = 0;
  int substeps = 8;                           ///< of the probe in one device period
  std::int64_t longest_step_ns = 20'000'000;  ///< a later tick advances the probe by this much only
};

/// The same with the nominal period of a session, where the caller has stated none.
[[nodiscard]] inline control_settings with_period(control_settings settings, std::int64_t device_period_ns) noexcept {
  if (settings.rates.period_ns == 0) settings.rates.period_ns = device_period_ns;
  return settings;
}

}  // namespace asperity
