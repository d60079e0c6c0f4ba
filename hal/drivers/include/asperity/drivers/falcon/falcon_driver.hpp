// Finds Falcons.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asperity/device/driver.hpp"
#include "asperity/drivers/falcon/falcon_device.hpp"

namespace asperity {

/// Driver of the Novint Falcon over any USB: the system's (asperity::usb) or a virtual one.
class falcon_driver final : public device_driver {
 public:
  /// @param finder,clock outlive the driver and its devices
  falcon_driver(usb_finder& finder, io_clock& clock, falcon_settings settings = {})
      : finder_(&finder), clock_(&clock), settings_(std::move(settings)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "falcon"; }
  [[nodiscard]] driver_maturity maturity() const noexcept override { return driver_maturity::protocol_tested; }

  [[nodiscard]] result<std::vector<device_listing>> list() override {
    const auto found = finder_->list(falcon_vendor, falcon_product);
    if (!found) return found.error();
    std::vector<device_listing> listings;
    for (const usb_listing& usb : *found) {
      listings.push_back({.driver = std::string(name()),
                          .identity = identity_of(usb),
                          .path = usb.path,
                          .name = usb.name.empty() ? "Novint Falcon" : usb.name,
                          .maturity = maturity(),
                          .capabilities = falcon_capabilities(),
                          .not_openable = usb.not_openable});
    }
    return listings;
  }

  [[nodiscard]] result<any_device> make(const device_listing& which) override {
    const auto found = finder_->list(falcon_vendor, falcon_product);
    if (!found) return found.error();
    const usb_listing* match = nullptr;
    for (const usb_listing& usb : *found) {
      if (identity_of(usb) != which.identity) continue;
      if (match == nullptr || usb.path == which.path) match = &usb;
    }
    if (match == nullptr) {
      return error{error_code::io_failed,
                   "no Falcon with the identity '" + which.identity + "' is plugged in; list again"};
    }
    return any_device(falcon_device(*finder_, *clock_, *match, settings_));
  }

 private:
  [[nodiscard]] static std::string identity_of(const usb_listing& usb) { return "usb:0403:cb48:" + usb.serial; }

  usb_finder* finder_;
  io_clock* clock_;
  falcon_settings settings_;
};

}  // namespace asperity
