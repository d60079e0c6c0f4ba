// Every device that this build's drivers, and those in the driver path, can find.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/hal/device_directory.hpp"

namespace asperity::command {

/// A driver that could not be loaded: its file, and why.
struct refused_module {
  std::string file;
  std::string why;
};

/// The drivers of this program, what they found, and what was refused.
class known_devices {
 public:
  /// Loads the drivers and looks once. @param falcon_firmware the user's copy of a Falcon's image; may be empty
  explicit known_devices(const std::string& falcon_firmware = {});
  ~known_devices();

  [[nodiscard]] const device_directory& directory() const noexcept { return *directory_; }
  [[nodiscard]] const std::vector<refused_module>& refused() const noexcept { return refused_; }
  /// Names of the drivers that looked.
  [[nodiscard]] const std::vector<std::string>& drivers() const noexcept { return drivers_; }

  /// The device that a person means, open and not armed: identity, path, driver or a part of its name.
  /// Homing, where a device needs it, happens in here and may wait for a person.
  [[nodiscard]] result<any_device> open(const std::string& text) const;

 private:
  struct bus;
  std::unique_ptr<bus> bus_;  // outlives the drivers that use it
  std::unique_ptr<device_directory> directory_;
  std::vector<refused_module> refused_;
  std::vector<std::string> drivers_;
};

}  // namespace asperity::command
