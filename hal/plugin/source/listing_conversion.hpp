// Device listings to the C interface and back, in one way for drivers in this process and in another.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "asperity/core/status.hpp"
#include "asperity/device/driver.hpp"
#include "asperity/device/driver_conversion.hpp"

namespace asperity::plugin {

/// What a driver lists, without its capabilities. A text that does not end is empty.
[[nodiscard]] inline device_listing from_listing(std::string_view driver, const asperity_listing& l) {
  const auto text = [](std::span<const char> field) { return std::string(abi::get_text(field).value_or("")); };
  device_listing d{.driver = std::string(driver),
                   .identity = text(l.identity),
                   .path = text(l.path),
                   .name = text(l.name),
                   .maturity = static_cast<driver_maturity>(l.maturity)};
  if (std::string why = text(l.not_openable); !why.empty()) d.not_openable = std::move(why);
  return d;
}

/// What a driver is asked to make.
/// @return invalid_argument where a text is longer than the driver can have listed it
[[nodiscard]] inline result<asperity_listing> to_listing(const device_listing& which) {
  auto l = abi::blank<asperity_listing>();
  if (which.identity.size() >= sizeof l.identity || which.path.size() >= sizeof l.path) {
    return error{error_code::invalid_argument, "the identity or path of the device is longer than a driver can list"};
  }
  l.maturity = static_cast<std::uint32_t>(which.maturity);
  abi::put_text(l.identity, which.identity);
  abi::put_text(l.path, which.path);
  abi::put_text(l.name, which.name);
  return l;
}

}  // namespace asperity::plugin
