// Capabilities of a Falcon, its settings, and its faults.
#pragma once

#include <cstdint>
#include <string>

#include "asperity/core/export.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/drivers/falcon/falcon_torque.hpp"

namespace asperity {

inline constexpr std::uint16_t falcon_vendor = 0x0403;
inline constexpr std::uint16_t falcon_product = 0xcb48;

/// What is known of a Falcon. Its maker published no data sheet of the motors, and the factor from counts to newtons is
/// a guess (falcon_counts_per_n_m): all forces here are nominal, assumed and not measured. There is no torque: what a
/// command asks of it is dropped.
[[nodiscard]] ASPERITY_API device_capabilities falcon_capabilities() noexcept;

/// Why a Falcon stopped.
enum class falcon_fault : std::uint8_t {
  none,
  unplugged,
  link_failed,     ///< a transfer failed or was cut short
  link_full,       ///< the device takes nothing any more
  silent,          ///< frames go out and no report comes back
  not_believable,  ///< reports whose encoders cannot be true
  homing_lost,     ///< a leg forgot its index mark, as after a loss of power
  bad_command,     ///< the wrench was not finite or in a wrong frame
};

[[nodiscard]] constexpr const char* to_string(falcon_fault f) noexcept {
  switch (f) {
    case falcon_fault::none:
      return "none";
    case falcon_fault::unplugged:
      return "it was unplugged";
    case falcon_fault::link_failed:
      return "a USB transfer failed";
    case falcon_fault::link_full:
      return "it takes no more commands";
    case falcon_fault::silent:
      return "it does not answer any more";
    case falcon_fault::not_believable:
      return "its encoders report what cannot be true";
    case falcon_fault::homing_lost:
      return "a leg lost its index mark";
    case falcon_fault::bad_command:
      return "the commanded wrench was not finite or in a wrong frame";
  }
  return "unknown fault";
}

struct falcon_settings {
  std::string firmware_path{};                      ///< the user's copy of the image; needed after each power-on
  std::int16_t limit_counts = falcon_counts_limit;  ///< of each motor; a lower one is obeyed, a higher one is not
  int firmware_attempts = 3;
  std::int64_t wake_ns = 300'000'000;               ///< for the firmware's first report
  std::int64_t homing_timeout_ns = 60'000'000'000;  ///< for a person to push the grip in and pull it out
  std::int64_t silent_after_ns = 20'000'000;        ///< without a report: a fault
  int busy_limit = 3;       ///< commands in a row that the link did not take before it is a fault
  int doubt_limit = 5;      ///< reports in a row that are not believed before it is a fault
  int settle_reports = 20;  ///< that have to be believed in a row before it is ready
};

}  // namespace asperity
