// Where drivers are looked for.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"

namespace asperity::plugin {

/// The absolute folders in ASPERITY_DRIVER_PATH, separated by colons, then the folder of the installation
/// (lib/asperity/drivers). The variable is ignored in a program that runs with more rights than its user.
[[nodiscard]] std::vector<std::filesystem::path> search_path();

/// A file that looks like a driver, *.so. Nothing in it has run.
struct found_file {
  std::string name;  ///< the file's, without folder and .so: what a person enables it by
  std::filesystem::path file;
  std::optional<error> refused{};  ///< why it cannot be loaded, as far as the file shows it
};

/// What lies in the folders, in their order and by name within one. Each file is judged by driver_file and closed
/// again; none is loaded. Of two files with one name the first counts. A folder that is not there is no fault.
[[nodiscard]] std::vector<found_file> find_driver_files(std::span<const std::filesystem::path> folders);

}  // namespace asperity::plugin
