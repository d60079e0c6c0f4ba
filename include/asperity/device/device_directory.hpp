// All devices of all drivers: what is plugged in, what came and what went.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/device/driver.hpp"

namespace asperity {

/// What happened to a device between two looks.
enum class directory_change : std::uint8_t {
  arrived,
  departed,
  moved,  ///< the same device in another place: it left and came back, and is a new device to whoever had it open
};

[[nodiscard]] constexpr const char* to_string(directory_change c) noexcept {
  switch (c) {
    case directory_change::arrived:
      return "arrived";
    case directory_change::departed:
      return "departed";
    case directory_change::moved:
      return "moved";
  }
  return "unknown change";
}

struct directory_event {
  directory_change change = directory_change::arrived;
  device_listing device;    ///< as it is now; of a departed one, as it was
  std::string former_path;  ///< of a moved one
};

/// A driver that could not look, and why. What it had found before counts as gone.
struct driver_problem {
  std::string driver;
  error why;
};

/// Asks drivers what is there, and compares with the last answer. It opens nothing by itself: a device that arrives,
/// or returns, is listed, and somebody makes, opens and arms it. Never inside a tick; one thread at a time.
class ASPERITY_API device_directory {
 public:
  explicit device_directory(std::vector<std::unique_ptr<device_driver>> drivers) : drivers_(std::move(drivers)) {}

  /// Looks again. The first call reports everything as arrived.
  /// @return what changed since the last call: departures, moves, arrivals, each in the order of the listings
  std::vector<directory_event> refresh();

  /// What the last refresh() found, driver by driver.
  [[nodiscard]] std::span<const device_listing> devices() const noexcept { return devices_; }
  /// Drivers that could not look in the last refresh().
  [[nodiscard]] std::span<const driver_problem> problems() const noexcept { return problems_; }

  /// The one device that a person means: its identity, its path, its driver's name, or a part of its name.
  /// @return invalid_argument with the choices, where none or more than one fits
  [[nodiscard]] result<device_listing> find(std::string_view text) const;

  /// The device of a listing, not yet open. @return unsupported | invalid_argument | the driver's own error
  [[nodiscard]] result<any_device> make(const device_listing& which) const;

 private:
  [[nodiscard]] static const device_listing* same(std::span<const device_listing> in, const device_listing& d);
  [[nodiscard]] static std::string names(std::span<const device_listing* const> of);

  std::vector<std::unique_ptr<device_driver>> drivers_;
  std::vector<device_listing> devices_;
  std::vector<driver_problem> problems_;
};

}  // namespace asperity
