// HID devices of this machine: what is plugged in, and how to open one. Component asperity::hid, Linux.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/transport/hid_finder.hpp"

namespace asperity::hid {

/// What is plugged in now, sorted by path. An empty list is not an error. A device that leaves meanwhile is left out.
/// Reads some files of the system for every node: not for a tick.
[[nodiscard]] result<std::vector<hid_listing>> list_hid();

/// Opens a node. It is opened, asked and read by way of the kernel's own interface (see third_party_notes/hidapi.md):
/// a node that vanishes at any moment of this is an error value.
///
/// The link owns the node and never waits in read(), which is one system call; the kernel keeps 63 reports that nobody
/// read, the oldest ones. write() is one system call in which the kernel hands the report to the device: on USB it
/// waits until the device has it, some milliseconds with a slow one. Neither allocates, not even where a call fails.
/// @return io_failed (not there, no permission: with the rule that gives it) | unsupported (not a HID node)
[[nodiscard]] result<std::unique_ptr<hid_link>> open_hid(const std::string& path);

/// Opens a listed device and checks that it is still the same one, because the system reuses paths.
/// @return as above, or io_failed where another device is there now
[[nodiscard]] result<std::unique_ptr<hid_link>> open_hid(const hid_listing& which);

/// The line for a file in /etc/udev/rules.d that lets whoever sits at the machine open this device.
[[nodiscard]] std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id);

/// The HID devices of this machine, for drivers.
class system_finder final : public hid_finder {
 public:
  [[nodiscard]] result<std::vector<hid_listing>> list() override { return list_hid(); }
  [[nodiscard]] result<std::unique_ptr<hid_link>> open(const hid_listing& which) override { return open_hid(which); }
};

}  // namespace asperity::hid
