#include "asperity/device/device_directory.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace asperity {

std::vector<directory_event> device_directory::refresh() {
  std::vector<device_listing> now;
  problems_.clear();
  for (const auto& driver : drivers_) {
    result<std::vector<device_listing>> found = driver->list();
    if (!found) {
      problems_.push_back({std::string(driver->name()), found.error()});
      continue;
    }
    std::move(found->begin(), found->end(), std::back_inserter(now));
  }

  std::vector<directory_event> events;
  for (const device_listing& before : devices_) {
    if (same(now, before) == nullptr) events.push_back({directory_change::departed, before, {}});
  }
  for (const device_listing& after : now) {
    const device_listing* before = same(devices_, after);
    if (before != nullptr && before->path != after.path) {
      events.push_back({directory_change::moved, after, before->path});
    }
  }
  for (const device_listing& after : now) {
    if (same(devices_, after) == nullptr) events.push_back({directory_change::arrived, after, {}});
  }
  devices_ = std::move(now);
  return events;
}

result<device_listing> device_directory::find(std::string_view text) const {
  for (const auto whole : {&device_listing::identity, &device_listing::path}) {
    for (const device_listing& d : devices_) {
      if (d.*whole == text) return d;
    }
  }
  std::vector<const device_listing*> fitting;
  for (const device_listing& d : devices_) {
    if (d.driver == text || (!text.empty() && d.name.find(text) != std::string::npos)) fitting.push_back(&d);
  }
  if (fitting.size() == 1) return *fitting.front();
  const std::string wanted = std::string("'").append(text) + "'";
  if (fitting.empty()) {
    for (const device_listing& d : devices_) fitting.push_back(&d);
    return error{error_code::invalid_argument,
                 fitting.empty() ? "no device " + wanted + " is plugged in, nor any other"
                                 : "no device " + wanted + " is plugged in; there are: " + names(fitting)};
  }
  return error{error_code::invalid_argument,
               wanted + " fits several devices; name one by its identity: " + names(fitting)};
}

result<any_device> device_directory::make(const device_listing& which) const {
  if (which.not_openable) return error{error_code::io_failed, which.name + ": " + *which.not_openable};
  for (const auto& driver : drivers_) {
    if (driver->name() == which.driver) return driver->make(which);
  }
  return error{error_code::invalid_argument, "there is no driver '" + which.driver + "' in this directory"};
}

const device_listing* device_directory::same(std::span<const device_listing> in, const device_listing& d) {
  const auto it = std::find_if(in.begin(), in.end(), [&d](const device_listing& other) {
    return other.driver == d.driver && other.identity == d.identity;
  });
  return it == in.end() ? nullptr : &*it;
}

std::string device_directory::names(std::span<const device_listing* const> of) {
  std::string out;
  for (const device_listing* d : of) out += (out.empty() ? "" : ", ") + d->identity + " (" + d->name + ")";
  return out;
}

}  // namespace asperity
