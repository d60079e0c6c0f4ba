// `asperity devices --view`: a device on a page, live, and a small force to try it with.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli.hpp"
#include "known_devices.hpp"

namespace asperity::command {

struct panel_command {
  std::string view;  ///< port, or no number: the usual one
  std::string view_address = "127.0.0.1";
  std::string device = "simulated";
  std::string firmware;
  driver_choice drivers;
  std::optional<double> seconds;  ///< none: until a signal
  std::uint64_t seed = 1;         ///< of the simulated hand
};

/// Opens the device, shows it until a signal or the end of its time, and takes its output to zero.
/// @return what was measured and which forces were put out | invalid_argument | io_failed | errors of the device
[[nodiscard]] result<answer> show_device(const panel_command& options, const common_options& common);

}  // namespace asperity::command
