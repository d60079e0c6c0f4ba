// A driver in a process of its own: what it breaks there does not break this program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/device/driver.hpp"
#include "asperity/plugin/driver_file.hpp"
#include "asperity/plugin/plugin_device.hpp"

namespace asperity::plugin {

/// How a tick waits for the driver's process.
enum class child_pace : std::uint8_t {
  /// For a session on CLOCK_MONOTONIC. read() waits for its measurement for child_settings::wait_ns, twice at the most,
  /// and gives the last one again where none came; write() and disarm() do not wait.
  paced,
  /// For a virtual clock: every call waits until the driver has answered, so that a session has the same bits as in
  /// process. Not for a session with a real hand.
  lockstep,
};

/// Times of a driver's process. The defaults are those that docs/explanation/plugin-threats.md states.
struct child_settings {
  child_pace pace = child_pace::paced;
  std::int64_t wait_ns = 150'000;                   ///< one wait of a paced read(): 15 % of a tick of 1 ms
  std::int64_t silence_ns = 20'000'000;             ///< session time without an answer (and 3 reads) that makes a fault
  std::int64_t disarm_after_ns = 100'000'000;       ///< of the program's silence, after its last command has expired
  std::int64_t list_patience_ns = 1'700'000'000;    ///< for loading the driver and its list() together
  std::int64_t call_patience_ns = 1'500'000'000;    ///< for each other call outside a tick ...
  std::int64_t open_patience_ns = 120'000'000'000;  ///< ... but open(), which may wait for a person
  std::int64_t farewell_ns = 200'000'000;           ///< for a process to end by itself before it is ended
  std::function<bool()> cancelled{};                ///< asked while waiting for open(); true gives it up
  std::filesystem::path host_program{};             ///< the helper, asperity-driver-host; empty: looked for
};

/// device_driver for a driver that is not trusted with this process. Linux.
///
/// The driver is loaded, asked and run in a process that is started for it: first to list, and the same one goes on
/// with the first device that is made of the list; each further device, and each further list, has its own. A crash, an
/// abort, an exit or a hang there is an error of the call outside a tick, and in a tick device_state::fault of the
/// device, latched, with the cause in its text. clear_fault() starts the driver anew.
class child_driver final : public device_driver {
 public:
  /// Judges the file, starts a process and loads the driver there. @return how that ended where it did not succeed
  [[nodiscard]] static result<std::unique_ptr<child_driver>> load(const std::filesystem::path& file,
                                                                  child_settings settings = {},
                                                                  file_trust trust = file_trust::owner_only);
  ~child_driver() override;

  /// As its table says; it cannot be told before it was loaded once.
  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] driver_maturity maturity() const noexcept override;
  /// Within child_settings::list_patience_ns, whatever the driver does.
  [[nodiscard]] result<std::vector<device_listing>> list() override;
  [[nodiscard]] result<any_device> make(const device_listing& which) override;
  /// As make(), with the type kept.
  [[nodiscard]] result<plugin_device> make_plugin(const device_listing& which);

  /// What happened to the processes of the devices that were made, one sentence each; empty where all is well.
  [[nodiscard]] std::string what_happened() const;

 private:
  class body;
  explicit child_driver(std::unique_ptr<body> b) noexcept;

  std::unique_ptr<body> body_;
};

}  // namespace asperity::plugin
