// Every device that this build's drivers, and those of others that a person chose, can find.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/device/device_directory.hpp"

namespace asperity::plugin {
class child_driver;
}

namespace asperity::command {

/// Which drivers in shared objects may run. By the name of their file without .so, or a path.
struct driver_choice {
  std::vector<std::string> enabled;     ///< in a process of their own
  std::vector<std::string> in_process;  ///< in this one: what they break, breaks the command
};

/// A driver of others that lies in the driver path, and what became of it.
struct driver_in_path {
  std::string name;
  std::string file;
  bool enabled = false;     ///< somebody asked for it, so that its code ran
  bool in_process = false;  ///< in this process
  std::optional<std::string> problem{};
  std::string driver{};  ///< what it calls itself, where it was loaded
};

/// The drivers of this program, what they found, and what was refused.
class known_devices {
 public:
  /// Loads the drivers that were chosen and looks once. Of the others only the files are looked at.
  /// @param device what a person named; a driver in the path of that name is enabled by it
  /// @param falcon_firmware the user's copy of a Falcon's image; may be empty
  /// @return invalid_argument where a driver was chosen that is not there
  [[nodiscard]] static result<std::unique_ptr<known_devices>> look(driver_choice choice, const std::string& device = {},
                                                                   const std::string& falcon_firmware = {});
  known_devices(const known_devices&) = delete;
  known_devices& operator=(const known_devices&) = delete;
  ~known_devices();

  [[nodiscard]] const device_directory& directory() const noexcept { return *directory_; }
  /// Everything in the driver path, and what was chosen from elsewhere.
  [[nodiscard]] const std::vector<driver_in_path>& in_path() const noexcept { return in_path_; }
  /// Names of the drivers that looked.
  [[nodiscard]] const std::vector<std::string>& drivers() const noexcept { return drivers_; }

  /// The device that a person means, open and not armed: identity, path, driver or a part of its name.
  /// Homing, where a device needs it, happens in here and may wait for a person.
  [[nodiscard]] result<any_device> open(const std::string& text) const;
  /// What became of drivers' processes since; empty where all is well.
  [[nodiscard]] std::string what_happened() const;

 private:
  struct bus;
  using driver_list = std::vector<std::unique_ptr<device_driver>>;

  known_devices();
  [[nodiscard]] result<void> load_plugins(driver_choice choice, const std::string& device, driver_list& all);

  std::shared_ptr<bus> bus_;  // outlives the drivers that use it
  std::unique_ptr<device_directory> directory_;
  std::vector<driver_in_path> in_path_;
  std::vector<std::string> drivers_;
  std::vector<plugin::child_driver*> children_;  // of the directory's
};

}  // namespace asperity::command
