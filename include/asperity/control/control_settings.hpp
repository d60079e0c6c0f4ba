// Settings of a device loop.
#pragma once

#include <algorithm>
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

/// Periods of the two loops, and what follows from both.
///
/// A device tick tells one pose of the probe, and of a pose there is one contact. So a contact loop that is faster than
/// the device loop finds no more poses; it hands the contact of a pose over sooner.
struct loop_periods {
  std::int64_t device_ns = 1'000'000;
  std::int64_t contact_ns = 1'000'000;

  /// Time between two contacts, ns: what a hand does in it decides which planes are told and how soft contacts are.
  [[nodiscard]] constexpr std::int64_t renewal_ns() const noexcept { return std::max(device_ns, contact_ns); }
  /// No contact that is used by loops in time is as old, ns. Its pose waits for a contact tick, the contact is handed
  /// over one period later, and it is used until the next one is handed over and the device ticks.
  [[nodiscard]] constexpr std::int64_t oldest_contact_ns() const noexcept { return 2 * contact_ns + device_ns; }
};

/// Settings of the device loop. The defaults are those of science, section 8.
struct control_settings {
  probe_settings probe{};
  coupling_settings coupling{};
  contact_law contact{};         ///< of support planes, see check(); a linear contact brings its own stiffness
  friction_settings friction{};  ///< on support planes, see check()
  /// What the probe's surface and each fixed body's make of a touch, in the place of the two above: surfaces_of() a
  /// scene takes it from the models' materials. Empty: the two above hold for all bodies.
  surface_pairs surfaces{};
  /// Gaps that every contact should tell at least, m; see gaps_for(). A millimetre is for the search of the pose of rest,
  /// which looks 0.1 mm and 5 mrad around: with half of it a press with 10 N stepped by 0.4 N/ms at rest. What a hand
  /// begins to do in a period of a slow loop takes more.
  double least_gaps_m = 1e-3;
  bool local_model = true;         ///< planes are read again in each substep, see local_model
  transient_settings transient{};  ///< of a first touch, see check(); none by default
  guard_settings guard{};
  weight_settings weight{};  ///< of the handle, see check(); none by default
  contact_ageing ageing{};   ///< how old a contact may be felt
  rate_limits rates{};       ///< how late the loops may be
  workspace_map map{};
  clutch_settings clutch{};  ///< none by default
  sample_check_settings samples{};
  /// Of the handle, for the coupling's damper. With window and device an encoder's step is no blow.
  velocity_source velocity = velocity_source::poses;
  gate_limits limits{.peak_force_n = 1e6,
                     .continuous_force_n = 1e6,
                     .force_slew_n_per_s = 1e6,
                     .peak_torque_n_m = 1e6,
                     .continuous_torque_n_m = 1e6,
                     .torque_slew_n_m_per_s = 1e6};  ///< the application's; the device's own apply where they are lower
  double low_pass_hz = output_gate::no_low_pass;     ///< cut-off of the gate's low-pass on the wrench; infinite: none
  /// Silence of the application after which the gate shuts (watchdog); 0: no watchdog. See exchange::application.
  std::int64_t watchdog_ns = 0;
  /// Substeps of the probe in a device period of a millisecond or longer. A shorter one has so many fewer that none is
  /// shorter than those of a millisecond; it has one at least.
  int substeps = 8;
  std::int64_t longest_step_ns = 20'000'000;  ///< a later tick advances the probe by this much only
};

/// The laws of these settings for every body's planes.
[[nodiscard]] inline contact_laws laws_of(const control_settings& settings) {
  return {settings.contact, settings.surfaces};
}

/// The same with the nominal period of a session, where the caller has stated none. A contact that is as old as these
/// loops make it, and one more period late, is no surprise, down to 100 Hz: slower loops are a surprise as such.
[[nodiscard]] inline control_settings with_periods(control_settings settings, const loop_periods& periods) noexcept {
  if (settings.rates.period_ns == 0) settings.rates.period_ns = periods.device_ns;
  constexpr loop_periods slowest{10'000'000, 10'000'000};
  const std::int64_t usual_ns =
      std::min(periods.oldest_contact_ns() + periods.renewal_ns(), slowest.oldest_contact_ns() + slowest.renewal_ns());
  settings.rates.surprise_age_ns = std::max(settings.rates.surprise_age_ns, usual_ns);
  constexpr double begins_at_m_per_s = 0.5;
  const double begins_in_world = std::max(1.0, settings.map.scale) * begins_at_m_per_s;
  settings.least_gaps_m =
      std::max(settings.least_gaps_m, begins_in_world * 1e-9 * static_cast<double>(periods.renewal_ns()));
  return settings;
}

}  // namespace asperity
