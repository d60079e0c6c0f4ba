// The two ways to find HID devices.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "asperity/hid/hid.hpp"

namespace asperity::hid {

/// Whether a version of hidapi may be asked for its devices. Before 0.15 it follows a null pointer where a device
/// leaves while it lists (its issue 580), and nothing from outside can prevent that.
[[nodiscard]] constexpr bool may_list(int hidapi_major, int hidapi_minor) noexcept {
  return hidapi_major > 0 || hidapi_minor >= 15;
}

/// From the kernel's own files, below these two folders.
[[nodiscard]] std::vector<hid_listing> list_from_sysfs(const std::filesystem::path& sys = "/sys",
                                                       const std::filesystem::path& dev = "/dev");

/// From hidapi, whatever its version.
[[nodiscard]] std::vector<hid_listing> list_from_hidapi();

/// Why the node cannot be opened for reading and writing by this process; empty where it can.
[[nodiscard]] std::optional<std::string> why_not_openable(const hid_listing& which);
/// The same from the error number of the attempt.
[[nodiscard]] std::string explain_open_error(const std::string& path, int error_number, const std::string& rule);

}  // namespace asperity::hid
