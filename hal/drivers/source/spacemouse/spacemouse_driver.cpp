#include "asperity/drivers/spacemouse/spacemouse_driver.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "asperity/drivers/hid/report_descriptor.hpp"
#include "asperity/drivers/spacemouse/products.hpp"

namespace asperity {
namespace {

// Page 1, usage 8: the kind of device that a SpaceMouse says it is. Receivers have other interfaces besides.
bool is_multi_axis(const hid_listing& which) {
  if (which.report_descriptor.empty()) return true;  // nothing is known: opening it will tell
  const report_descriptor d = parse_report_descriptor(which.report_descriptor);
  for (const hid_field& f : d.fields) {
    if (f.top_page == 0x01 && f.top_usage == 0x08) return true;
  }
  return false;
}

}  // namespace

std::optional<device_listing> as_spacemouse(const hid_listing& which, const spacemouse_settings& settings) {
  const spacemouse_product* const product = find_spacemouse(which.vendor_id, which.product_id);
  if (product == nullptr || !is_multi_axis(which)) return std::nullopt;
  device_listing one;
  one.driver = "spacemouse";
  one.identity = identity_of(which);
  one.path = which.path;
  one.name = product->name;
  one.maturity = driver_maturity::protocol_tested;
  spacemouse_settings named = settings;
  named.name = product->name;
  one.capabilities = spacemouse_device({}, named).capabilities();
  one.not_openable = which.not_openable;
  return one;
}

result<hid_listing> find_spacemouse_again(const std::vector<hid_listing>& now, const std::string& identity,
                                          const std::string& last_path) {
  const hid_listing* found = nullptr;
  std::size_t candidates = 0;
  for (const hid_listing& l : now) {
    if (identity_of(l) != identity || !as_spacemouse(l)) continue;
    if (l.path == last_path) return l;
    found = &l;
    ++candidates;
  }
  if (candidates == 1) return *found;
  if (candidates == 0) {
    return error{error_code::io_failed, "the SpaceMouse " + identity + " is not plugged in, or its receiver is not"};
  }
  return error{error_code::io_failed, "there are " + std::to_string(candidates) + " SpaceMice " + identity +
                                          " without serial numbers, and none is where it was (" + last_path +
                                          "): list the devices again and choose one"};
}

result<std::vector<device_listing>> spacemouse_driver::list() {
  result<std::vector<hid_listing>> all = finder_->list();
  if (!all) return all.error();
  std::vector<device_listing> found;
  for (const hid_listing& l : *all) {
    if (std::optional<device_listing> one = as_spacemouse(l, settings_)) found.push_back(std::move(*one));
  }
  return found;
}

result<spacemouse_device> spacemouse_driver::make_spacemouse(const device_listing& which) {
  if (which.driver != name()) {
    return error{error_code::invalid_argument,
                 "the device " + which.identity + " was found by the driver " + which.driver + ", not by spacemouse"};
  }
  spacemouse_settings settings = settings_;
  for (const spacemouse_product& p : spacemouse_products) {
    if (p.name == which.name) settings.name = p.name;
  }
  return spacemouse_device(
      [finder = finder_, identity = which.identity, path = which.path]() mutable -> result<std::unique_ptr<hid_link>> {
        result<std::vector<hid_listing>> all = finder->list();
        if (!all) return all.error();
        result<hid_listing> now = find_spacemouse_again(*all, identity, path);
        if (!now) return now.error();
        result<std::unique_ptr<hid_link>> link = finder->open(*now);
        if (link) path = now->path;
        return link;
      },
      settings);
}

result<any_device> spacemouse_driver::make(const device_listing& which) {
  result<spacemouse_device> device = make_spacemouse(which);
  if (!device) return device.error();
  return any_device(std::move(*device));
}

}  // namespace asperity
