// A driver: finds devices of one kind and opens them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/device/any_device.hpp"
#include "asperity/device/capabilities.hpp"

namespace asperity {

/// A device that is plugged in.
struct device_listing {
  std::string driver;    ///< name of the driver that found it
  std::string identity;  ///< the same whatever it is plugged into: vendor, product, serial number
  std::string path;      ///< where it is now; changes when it returns
  std::string name;      ///< for people
  driver_maturity maturity = driver_maturity::protocol_tested;
  device_capabilities capabilities{};         ///< as far as they are known before opening
  std::optional<std::string> not_openable{};  ///< why it cannot be opened, and how to mend it
};

/// Finds and opens devices of one kind, from this library or from a vendor's (driver_abi.h). Never inside a tick.
class device_driver {
 public:
  device_driver() = default;
  device_driver(const device_driver&) = delete;
  device_driver& operator=(const device_driver&) = delete;
  virtual ~device_driver() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual driver_maturity maturity() const noexcept = 0;
  /// What is plugged in now. An empty list is not an error.
  [[nodiscard]] virtual result<std::vector<device_listing>> list() = 0;
  /// A device in state present; its own open() takes the handle.
  [[nodiscard]] virtual result<any_device> make(const device_listing& which) = 0;
};

}  // namespace asperity
