// The virtual coupling of a session: given, or what its device can show.
#pragma once

#include <string>

#include "asperity/control/probe.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/device/capabilities.hpp"
#include "cli.hpp"
#include "run_command.hpp"

namespace asperity::command {

/// Where a stiffness comes from.
enum class coupling_source : std::uint8_t {
  usual,   ///< coupling_settings's own
  device,  ///< coupling_for() the device, for contacts as support planes
  given,   ///< by an option
};

struct chosen_coupling {
  coupling_settings settings{};
  coupling_source translation = coupling_source::usual, rotation = coupling_source::usual;
};

/// Support planes are far stiffer than any device: what a hand feels of them is the coupling, so it is as stiff as the
/// device says that it can show. Softer contacts keep the usual one.
/// @param scale workspace_map::scale
[[nodiscard]] chosen_coupling coupling_of(const run_command& options, const device_capabilities& device, double scale);

[[nodiscard]] json to_json(const chosen_coupling& chosen, const probe_settings& probe);
[[nodiscard]] std::string to_text(const chosen_coupling& chosen, const probe_settings& probe);

}  // namespace asperity::command
