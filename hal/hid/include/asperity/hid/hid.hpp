// HID devices that are plugged in, and how to open one. Component asperity::hid, Linux.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/transport/hid_link.hpp"

namespace asperity::hid {

/// One HID interface that is plugged in. A device can have several.
struct hid_listing {
  std::string path;  ///< of its node, as /dev/hidraw3; another one when it returns
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string serial;  ///< empty where the device has none
  std::string product;
  std::string manufacturer;
  int interface_number = -1;                    ///< -1 where it is not on USB
  std::vector<std::uint8_t> report_descriptor;  ///< empty where the system does not give it
  std::optional<std::string> not_openable{};    ///< why, and how to mend it
};

/// Identity that does not depend on where the device is plugged in: "046d:c626", with ":serial" where it has one. Two
/// devices of one kind without serial numbers have one identity.
[[nodiscard]] std::string identity_of(const hid_listing& which);

/// What is plugged in now, sorted by path. An empty list is not an error. A device that leaves meanwhile is left out.
/// Reads some files of the system for every node: not for a tick.
[[nodiscard]] result<std::vector<hid_listing>> list_hid();

/// Opens a node. It is opened, asked and read by way of the kernel's own interface (see third_party_notes/hidapi.md):
/// a node that vanishes at any moment of this is an error value.
/// @return io_failed (not there, no permission: with the rule that gives it) | unsupported (not a HID node)
[[nodiscard]] result<std::unique_ptr<hid_link>> open_hid(const std::string& path);

/// Opens a listed device and checks that it is still the same one, because the system reuses paths.
/// @return as above, or io_failed where another device is there now
[[nodiscard]] result<std::unique_ptr<hid_link>> open_hid(const hid_listing& which);

/// The line for a file in /etc/udev/rules.d that lets whoever sits at the machine open this device.
[[nodiscard]] std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id);

}  // namespace asperity::hid
