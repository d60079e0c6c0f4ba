// Where drivers are looked for.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/plugin/plugin_driver.hpp"

namespace asperity::plugin {

/// The absolute folders in ASPERITY_DRIVER_PATH, separated by colons, then the folder of the installation
/// (lib/asperity/drivers). The variable is ignored in a program that runs with more rights than its user.
[[nodiscard]] std::vector<std::filesystem::path> search_path();

/// A file that looks like a driver and cannot be used.
struct refused_driver {
  std::filesystem::path file;
  error why;
};

struct found_drivers {
  std::vector<std::unique_ptr<plugin_driver>> drivers;
  std::vector<refused_driver> refused;
};

/// Loads every *.so of the folders, in their order and by name within one. Where two drivers have the same name the
/// first counts. A folder that is not there is no fault.
[[nodiscard]] found_drivers load_drivers(std::span<const std::filesystem::path> folders, const log_sink& log = {});

}  // namespace asperity::plugin
