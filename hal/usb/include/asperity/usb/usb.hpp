// USB devices of this machine, by libusb. Component asperity::usb.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/transport/usb_finder.hpp"

namespace asperity::usb {

/// Devices that are plugged in now. Each call looks anew, so that arrival and departure show as a difference of two
/// lists; nothing has to run in between. A device that cannot be opened is listed with the reason.
/// @param vendor,product 0 for any
/// @return unsupported: this kernel has no USB | io_failed
[[nodiscard]] result<std::vector<usb_listing>> list_usb(std::uint16_t vendor = 0, std::uint16_t product = 0);

/// Claims an interface and starts to read from it. A driver of the kernel that holds it is taken off, and put back when
/// the link is destroyed.
///
/// All transfers and their buffers are made here. The link has no thread: what has ended is collected inside read() and
/// write(), by one call of libusb that does not wait, in the thread that calls them. So nothing runs between two ticks,
/// the order of events is that of the calls, and no lock is ever held by anybody else. The price is the time stamp: a
/// packet is as old as the tick that collects it, which is the last moment at which it can have arrived.
/// Inside a tick this polls, and enters the kernel once for each transfer that is submitted. It takes locks of libusb
/// that nobody contends for. libusb itself takes a block of heap for every transfer that it submits and gives it back
/// when that ends: one call of calloc() per packet and per write is the only allocation in a tick.
///
/// The destructor waits at most 100 ms for what was written to go out, cancels the rest and waits at most 500 ms more.
/// @return invalid_argument: the device has no such endpoints | io_failed: gone, in use or not permitted; the message
///         then has the line for udev
[[nodiscard]] result<std::unique_ptr<usb_link>> open_usb(const usb_listing& which, const usb_pipes& pipes = {});

/// The line in a file of /etc/udev/rules.d that lets the person at the machine open such a device.
[[nodiscard]] std::string udev_rule(std::uint16_t vendor, std::uint16_t product);

/// The bus of this machine, for drivers.
class system_finder final : public usb_finder {
 public:
  [[nodiscard]] result<std::vector<usb_listing>> list(std::uint16_t vendor, std::uint16_t product) override {
    return list_usb(vendor, product);
  }
  [[nodiscard]] result<std::unique_ptr<usb_link>> open(const usb_listing& which, const usb_pipes& pipes) override {
    return open_usb(which, pipes);
  }
};

}  // namespace asperity::usb
