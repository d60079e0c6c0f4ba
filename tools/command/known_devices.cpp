#include "known_devices.hpp"

#include <algorithm>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "interrupt.hpp"
#include "patient_driver.hpp"
#ifdef ASPERITY_HAS_HID
#include "asperity/drivers/spacemouse/spacemouse_driver.hpp"
#include "asperity/hid/hid.hpp"
#endif
#ifdef ASPERITY_HAS_USB
#include "asperity/drivers/falcon/falcon_driver.hpp"
#include "asperity/transport/real_clock.hpp"
#include "asperity/usb/usb.hpp"
#endif
#ifdef ASPERITY_HAS_PLUGIN
#include "asperity/plugin/child_driver.hpp"
#include "asperity/plugin/driver_search.hpp"
#include "asperity/plugin/plugin_driver.hpp"
#endif

namespace asperity::command {

struct known_devices::bus {
#ifdef ASPERITY_HAS_HID
  hid::system_finder hid;
#endif
#ifdef ASPERITY_HAS_USB
  usb::system_finder usb;
  real_clock clock;
#endif
};

known_devices::known_devices() : bus_(std::make_shared<bus>()) {}
known_devices::~known_devices() = default;

#ifdef ASPERITY_HAS_PLUGIN
namespace {

bool is_named(const driver_in_path& d, const std::string& text) { return text == d.name || text == d.file; }

bool any_names(const std::vector<std::string>& texts, const driver_in_path& d) {
  return std::any_of(texts.begin(), texts.end(), [&d](const std::string& text) { return is_named(d, text); });
}

// What a person chose that is neither in the path nor a file.
error not_there(const std::string& text, const std::vector<driver_in_path>& in_path) {
  std::string names;
  for (const driver_in_path& d : in_path) names += (names.empty() ? "" : ", ") + d.name;
  return {error_code::invalid_argument,
          "there is no driver '" + text + "' to enable; in the driver path " +
              (names.empty() ? "there is none: set ASPERITY_DRIVER_PATH, or give a file with its folder"
                             : "there are: " + names)};
}

}  // namespace

result<void> known_devices::load_plugins(driver_choice choice, const std::string& device, driver_list& all) {
  for (plugin::found_file& f : plugin::find_driver_files(plugin::search_path())) {
    driver_in_path d{.name = std::move(f.name), .file = f.file.string()};
    if (f.refused) d.problem = f.refused->message;
    in_path_.push_back(std::move(d));
  }
  for (const auto* texts : {&choice.enabled, &choice.in_process}) {
    for (const std::string& text : *texts) {
      const bool known =
          std::any_of(in_path_.begin(), in_path_.end(), [&text](const driver_in_path& d) { return is_named(d, text); });
      if (!known && text.find('/') == std::string::npos) return not_there(text, in_path_);
      if (!known) in_path_.push_back({.name = std::filesystem::path(text).stem().string(), .file = text});
    }
  }
  if (!device.empty()) choice.enabled.push_back(device);

  for (driver_in_path& d : in_path_) {
    d.in_process = any_names(choice.in_process, d);
    d.enabled = d.in_process || any_names(choice.enabled, d);
    if (!d.enabled || d.problem) continue;
    const auto keep = [&](auto driver) {
      if (!driver) {
        d.problem = driver.error().message;
        return;
      }
      d.driver = (*driver)->name();
      const auto same =
          std::find_if(all.begin(), all.end(), [&](const auto& other) { return other->name() == (*driver)->name(); });
      if (same != all.end()) {
        d.problem = d.file + ": there is a driver named " + std::string((*driver)->name()) + " already";
        return;
      }
      if constexpr (std::is_same_v<std::decay_t<decltype(**driver)>, plugin::child_driver>) {
        children_.push_back(driver->get());
      }
      all.push_back(std::move(driver).value());
    };
    if (d.in_process) {
      keep(plugin::plugin_driver::load(d.file));
    } else {
      plugin::child_settings options;
      options.cancelled = [] { return interrupted(); };
      keep(plugin::child_driver::load(d.file, std::move(options)));
    }
  }
  return {};
}

std::string known_devices::what_happened() const {
  std::string out;
  for (const plugin::child_driver* c : children_) {
    const std::string text = c->what_happened();
    if (!text.empty()) out += (out.empty() ? "" : "; ") + text;
  }
  return out;
}
#else
result<void> known_devices::load_plugins(driver_choice choice, const std::string&, driver_list&) {
  if (choice.enabled.empty() && choice.in_process.empty()) return {};
  return error{error_code::unsupported, "drivers in shared objects are not part of this build"};
}
std::string known_devices::what_happened() const { return {}; }
#endif

result<std::unique_ptr<known_devices>> known_devices::look(driver_choice choice, const std::string& device,
                                                           [[maybe_unused]] const std::string& falcon_firmware) {
  std::unique_ptr<known_devices> known(new known_devices);
  driver_list all;
#ifdef ASPERITY_HAS_HID
  all.push_back(std::make_unique<patient_driver>(std::make_shared<spacemouse_driver>(known->bus_->hid), known->bus_));
#endif
#ifdef ASPERITY_HAS_USB
  falcon_settings falcon;
  falcon.firmware_path = falcon_firmware;
  all.push_back(std::make_unique<patient_driver>(
      std::make_shared<falcon_driver>(known->bus_->usb, known->bus_->clock, falcon), known->bus_));
#endif
  if (const result<void> loaded = known->load_plugins(std::move(choice), device, all); !loaded) return loaded.error();
  for (const auto& driver : all) known->drivers_.emplace_back(driver->name());
  known->directory_ = std::make_unique<device_directory>(std::move(all));
  static_cast<void>(known->directory_->refresh());
  return known;
}

result<any_device> known_devices::open(const std::string& text) const {
  // A file need not be called what the driver in it calls itself.
  const auto file = std::find_if(in_path_.begin(), in_path_.end(), [&text](const driver_in_path& d) {
    return !d.driver.empty() && (text == d.name || text == d.file);
  });
  const result<device_listing> which = directory_->find(file == in_path_.end() ? text : file->driver);
  if (!which) {
    error e = which.error();
    for (const driver_in_path& d : in_path_) {
      if (d.enabled && d.problem) e.message += "; driver " + d.name + ": " + *d.problem;
      if (!d.enabled)
        e.message += "; driver " + d.name + " lies in the driver path and was not asked: --enable " + d.name;
    }
    for (const driver_problem& p : directory_->problems()) e.message += "; " + p.driver + ": " + p.why.message;
    return e;
  }
  result<any_device> device = directory_->make(*which);
  if (!device) return device;
  if (const result<void> opened = device->open(); !opened) {
    if (interrupted()) return error{error_code::cancelled, "interrupted while the device was opened"};
    return opened.error();
  }
  return device;
}

}  // namespace asperity::command
