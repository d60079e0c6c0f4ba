// Which HID devices are there, and how one is opened: those of the system, or some in this process.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"
#include "asperity/transport/hid_link.hpp"

namespace asperity {

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
[[nodiscard]] ASPERITY_API std::string identity_of(const hid_listing& which);

/// Lists and opens. Arrival and departure are found by listing again: a list is taken anew each time. Never in a tick.
class hid_finder {
 public:
  hid_finder() = default;
  hid_finder(const hid_finder&) = delete;
  hid_finder& operator=(const hid_finder&) = delete;
  virtual ~hid_finder() = default;

  /// What is plugged in now, sorted by path; an empty list is no error.
  [[nodiscard]] virtual result<std::vector<hid_listing>> list() = 0;
  /// Opens what was listed, where it is still the same device.
  [[nodiscard]] virtual result<std::unique_ptr<hid_link>> open(const hid_listing& which) = 0;
};

}  // namespace asperity
