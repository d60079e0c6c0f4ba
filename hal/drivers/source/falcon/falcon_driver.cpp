#include "asperity/drivers/falcon/falcon_driver.hpp"

#include <string>
#include <utility>
#include <vector>

namespace asperity {

falcon_driver::falcon_driver(usb_finder& finder, io_clock& clock, falcon_settings settings)
    : finder_(&finder), clock_(&clock), settings_(std::move(settings)) {}

result<std::vector<device_listing>> falcon_driver::list() {
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

result<any_device> falcon_driver::make(const device_listing& which) {
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

}  // namespace asperity
