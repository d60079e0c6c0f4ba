#include "known_devices.hpp"

#include <utility>

#ifdef ASPERITY_HAS_HID
#include "asperity/hid/spacemouse_driver.hpp"
#endif
#ifdef ASPERITY_HAS_USB
#include "asperity/hal/falcon/falcon_driver.hpp"
#include "asperity/hal/transport/real_clock.hpp"
#include "asperity/usb/usb.hpp"
#endif
#ifdef ASPERITY_HAS_PLUGIN
#include "asperity/plugin/driver_search.hpp"
#endif

namespace asperity::command {

struct known_devices::bus {
#ifdef ASPERITY_HAS_USB
  usb::system_finder usb;
  real_clock clock;
#endif
};

known_devices::known_devices([[maybe_unused]] const std::string& falcon_firmware) : bus_(std::make_unique<bus>()) {
  std::vector<std::unique_ptr<device_driver>> all;
#ifdef ASPERITY_HAS_HID
  all.push_back(std::make_unique<hid::spacemouse_driver>());
#endif
#ifdef ASPERITY_HAS_USB
  falcon_config falcon;
  falcon.firmware_path = falcon_firmware;
  all.push_back(std::make_unique<falcon_driver>(bus_->usb, bus_->clock, falcon));
#endif
#ifdef ASPERITY_HAS_PLUGIN
  plugin::found_drivers found = plugin::load_drivers(plugin::search_path());
  for (auto& driver : found.drivers) all.push_back(std::move(driver));
  for (const plugin::refused_driver& r : found.refused) refused_.push_back({r.file.string(), r.why.message});
#endif
  for (const auto& driver : all) drivers_.emplace_back(driver->name());
  directory_ = std::make_unique<device_directory>(std::move(all));
  static_cast<void>(directory_->refresh());
}

known_devices::~known_devices() = default;

result<any_device> known_devices::open(const std::string& text) const {
  const result<device_listing> which = directory_->find(text);
  if (!which) {
    error e = which.error();
    for (const driver_problem& p : directory_->problems()) e.message += "; " + p.driver + ": " + p.why.message;
    return e;
  }
  result<any_device> device = directory_->make(*which);
  if (!device) return device;
  if (const result<void> opened = device->open(); !opened) return opened.error();
  return device;
}

}  // namespace asperity::command
