// What libusb hands out, given back when it is not needed any more.
#pragma once

#include <libusb-1.0/libusb.h>
#include <memory>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/transport/io_status.hpp"
#include "asperity/transport/usb_finder.hpp"

namespace asperity::usb {

struct context_end {
  void operator()(libusb_context* c) const noexcept { libusb_exit(c); }
};
using context = std::unique_ptr<libusb_context, context_end>;

struct handle_end {
  void operator()(libusb_device_handle* h) const noexcept { libusb_close(h); }
};
using handle = std::unique_ptr<libusb_device_handle, handle_end>;

/// Every device that a context sees now, each with a reference of its own.
class device_list {
 public:
  explicit device_list(libusb_context* session) noexcept { count_ = libusb_get_device_list(session, &devices_); }
  ~device_list() {
    if (count_ >= 0) libusb_free_device_list(devices_, 1);
  }
  device_list(const device_list&) = delete;
  device_list& operator=(const device_list&) = delete;

  [[nodiscard]] libusb_device** begin() const noexcept { return devices_; }
  [[nodiscard]] libusb_device** end() const noexcept { return count_ < 0 ? devices_ : devices_ + count_; }

 private:
  libusb_device** devices_ = nullptr;
  ssize_t count_ = 0;
};

/// A context of its own for every list and every link: none waits for another's lock.
[[nodiscard]] result<context> make_context();
/// Bus and ports, "1-2.4"; as the kernel names the device in /sys/bus/usb/devices.
[[nodiscard]] std::string path_of(libusb_device* device);
/// A sentence for what libusb answered while opening a device.
[[nodiscard]] std::string why_not_open(const usb_listing& which, int answer);
/// What a transport answers where libusb answered that. `busy` is never among it.
[[nodiscard]] io_status status_of(int answer) noexcept;

}  // namespace asperity::usb
