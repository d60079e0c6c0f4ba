// The USB transport: control requests outside a tick, one bulk or interrupt pipe each way inside it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/transport/io_status.hpp"

namespace asperity {

/// The eight bytes of a control request, USB 2.0 section 9.3.
struct usb_setup {
  std::uint8_t request_type = 0;  ///< bmRequestType; bit 7 set reads from the device
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// Bytes that have arrived.
struct usb_packet {
  std::size_t size = 0;           ///< bytes in the caller's buffer
  std::int64_t host_time_ns = 0;  ///< when the transfer ended, on the session's clock
};

/// One claimed interface of a USB device: libusb or an in-process twin of it.
/// Transfers are made when it is opened and used again and again. One thread at a time.
class usb_link {
 public:
  usb_link() = default;
  usb_link(const usb_link&) = delete;
  usb_link& operator=(const usb_link&) = delete;
  virtual ~usb_link() = default;

  /// One control request; waits for the device, so never inside a tick. `data` is sent, or filled in.
  /// @param done bytes sent or received
  /// @return ok | gone | refused (the device stalled it) | failed
  [[nodiscard]] virtual io_status control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done,
                                          std::int64_t timeout_ns) noexcept = 0;

  /// Sends bytes on the pipe to the device, and returns before they are there. What the device did not take shows in
  /// the answer to a later call.
  /// @return ok | busy (all transfers are under way) | gone | too_short (an earlier one) | refused (too long) | failed
  [[nodiscard]] virtual io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept = 0;

  /// The oldest packet that has arrived by now_ns. The pipe from the device is always being read.
  /// @return ok | nothing | gone | too_short (`bytes` cannot hold it; it is lost) | failed
  [[nodiscard]] virtual io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                       usb_packet& packet) noexcept = 0;
};

}  // namespace asperity
