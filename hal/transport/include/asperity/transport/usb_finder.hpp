// Which USB devices are there, and how one is opened: libusb, or a bus in this process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/transport/usb_link.hpp"

namespace asperity {

/// A USB device that is plugged in.
struct usb_listing {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string serial;                         ///< empty where the device has none, or could not be asked
  std::string path;                           ///< bus and ports, "1-2.4"; another one when it returns elsewhere
  std::string name;                           ///< maker and product, for people
  std::optional<std::string> not_openable{};  ///< why it cannot be opened, and how to mend it
};

/// The interface and endpoints to claim, and how many transfers are made for them.
struct usb_pipes {
  std::uint8_t interface = 0;
  std::uint8_t in = 0x81;           ///< address of the bulk or interrupt endpoint to the host
  std::uint8_t out = 0x02;          ///< address of the endpoint to the device
  std::size_t transfer_bytes = 64;  ///< of each transfer; to the host, a multiple of the endpoint's packet size
  std::size_t in_transfers = 8;     ///< always under way; what arrives beyond them waits in the device
  std::size_t out_transfers = 4;    ///< under way before write() answers busy
};

/// Lists and opens. Arrival and departure are found by listing again: a list is taken anew each time. Never in a tick.
class usb_finder {
 public:
  usb_finder() = default;
  usb_finder(const usb_finder&) = delete;
  usb_finder& operator=(const usb_finder&) = delete;
  virtual ~usb_finder() = default;

  /// What is plugged in now; an empty list is no error. @param vendor,product 0 for any
  [[nodiscard]] virtual result<std::vector<usb_listing>> list(std::uint16_t vendor, std::uint16_t product) = 0;
  /// Claims the interface of the device at which.path, where it is the same vendor's and product.
  [[nodiscard]] virtual result<std::unique_ptr<usb_link>> open(const usb_listing& which, const usb_pipes& pipes) = 0;
};

}  // namespace asperity
