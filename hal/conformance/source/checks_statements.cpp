#include <string>

#include "asperity/plugin/table_check.hpp"
#include "checks.hpp"

namespace asperity::conformance {
namespace {

void check_workspace(const asperity_capabilities& c, ledger& found) {
  for (int i = 0; i < 3; ++i) {
    if ((c.sensed >> i & 1U) == 0) continue;
    const double width = c.workspace_high_d_m[i] - c.workspace_low_d_m[i];
    found.look("units.workspace", width >= 0.001 && width <= 10.0, [&] {
      return "the workspace is " + std::to_string(width) + " m wide along axis " + std::to_string(i) +
             (width > 10.0 ? "; are these millimetres?" : "");
    });
  }
  found.skip("units.workspace", "the device senses no translation");
}

void check_efforts(const asperity_capabilities& c, ledger& found) {
  const bool force = (c.actuated & ASPERITY_AXES_TRANSLATION) != 0;
  const bool torque = (c.actuated & ASPERITY_AXES_ROTATION) != 0;
  if (force) {
    found.look("units.efforts", c.continuous_force_n > 0.0 && c.peak_force_n <= 1000.0 && c.force_slew_n_per_s > 0.0,
               [&] {
                 return "force: continuous " + std::to_string(c.continuous_force_n) + " N, peak " +
                        std::to_string(c.peak_force_n) + " N, slew " + std::to_string(c.force_slew_n_per_s) + " N/s";
               });
  }
  if (torque) {
    found.look("units.efforts",
               c.continuous_torque_n_m > 0.0 && c.peak_torque_n_m <= 100.0 && c.torque_slew_n_m_per_s > 0.0, [&] {
                 return "torque: continuous " + std::to_string(c.continuous_torque_n_m) + " N m, peak " +
                        std::to_string(c.peak_torque_n_m) + " N m, slew " + std::to_string(c.torque_slew_n_m_per_s) +
                        " N m/s";
               });
  }
  found.skip("units.efforts", "the device puts out nothing: it only measures");
}

}  // namespace

void check_statements(subject& device, ledger& found) {
  found.begin("statements");
  if (!device.reach(device_state::ready)) {
    found.look("states.present", false, [&] {
      return "open() does not lead to ready, but to " + std::string(to_string(device.state())) +
             (device.last_error().empty() ? "" : ": " + device.last_error());
    });
    return;
  }
  const asperity_capabilities& c = device.capabilities();
  const std::optional<std::string> problem = plugin::find_problem(c);
  found.look("capabilities.sound", !problem.has_value(), [&] { return *problem; });
  check_workspace(c, found);
  check_efforts(c, found);
  found.look("units.rates",
             c.nominal_rate_hz >= 10.0 && c.nominal_rate_hz <= 1e5 && c.minimum_rate_hz <= c.nominal_rate_hz, [&] {
               return "the nominal rate is " + std::to_string(c.nominal_rate_hz) + " Hz, the minimum rate " +
                      std::to_string(c.minimum_rate_hz) + " Hz";
             });
  device.look_at_capabilities();
}

}  // namespace asperity::conformance
