// From a listing to a claimed interface.
#include <string>
#include <utility>

#include "asperity/usb/usb.hpp"
#include "handles.hpp"
#include "libusb_link.hpp"

namespace asperity::usb {

namespace {

struct config_end {
  void operator()(libusb_config_descriptor* c) const noexcept { libusb_free_config_descriptor(c); }
};

error no_endpoints(const usb_listing& which, const std::string& what) {
  return {error_code::invalid_argument, "the USB device at " + which.path + " " + what};
}

struct endpoint_kind {
  bool interrupt = false;
  std::size_t packet_bytes = 0;
};

// What the device says of one endpoint of the interface.
result<endpoint_kind> look_at_endpoint(libusb_device* device, const usb_listing& which, std::uint8_t interface,
                                       std::uint8_t address) {
  libusb_config_descriptor* raw = nullptr;
  const int answer = libusb_get_active_config_descriptor(device, &raw);
  if (answer != 0) return error{error_code::io_failed, why_not_open(which, answer)};
  const std::unique_ptr<libusb_config_descriptor, config_end> config(raw);
  for (int i = 0; i < config->bNumInterfaces; ++i) {
    const libusb_interface& all = config->interface[i];
    if (all.num_altsetting == 0 || all.altsetting[0].bInterfaceNumber != interface) continue;
    for (int k = 0; k < all.altsetting[0].bNumEndpoints; ++k) {
      const libusb_endpoint_descriptor& e = all.altsetting[0].endpoint[k];
      const int kind = e.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
      if (e.bEndpointAddress != address) continue;
      if (kind != LIBUSB_TRANSFER_TYPE_BULK && kind != LIBUSB_TRANSFER_TYPE_INTERRUPT) break;
      return endpoint_kind{kind == LIBUSB_TRANSFER_TYPE_INTERRUPT, e.wMaxPacketSize & 0x7ffU};
    }
  }
  return no_endpoints(which, "has no bulk or interrupt endpoint " + std::to_string(address) + " in its interface " +
                                 std::to_string(interface));
}

}  // namespace

result<std::unique_ptr<usb_link>> open_usb(const usb_listing& which, const usb_pipes& pipes) {
  constexpr std::size_t most_bytes = 16384;
  constexpr std::size_t most_transfers = 64;
  if ((pipes.in & 0x80U) == 0 || (pipes.out & 0x80U) != 0 || pipes.transfer_bytes == 0 ||
      pipes.transfer_bytes > most_bytes || pipes.in_transfers == 0 || pipes.in_transfers > most_transfers ||
      pipes.out_transfers == 0 || pipes.out_transfers > most_transfers) {
    return error{
        error_code::invalid_argument,
        "the pipes asked for at " + which.path +
            " are not possible: one endpoint to the host, one to the device, 1 to 16384 bytes, 1 to 64 transfers"};
  }
  auto session = make_context();
  if (!session) return session.error();
  handle device;
  for (libusb_device* d : device_list(session->get())) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(d, &descriptor) != 0 || path_of(d) != which.path) continue;
    if (descriptor.idVendor != which.vendor || descriptor.idProduct != which.product) continue;
    libusb_device_handle* raw = nullptr;
    const int answer = libusb_open(d, &raw);
    if (answer != 0) return error{error_code::io_failed, why_not_open(which, answer)};
    device.reset(raw);
    break;
  }
  if (!device) return error{error_code::io_failed, why_not_open(which, LIBUSB_ERROR_NOT_FOUND)};

  const auto in = look_at_endpoint(libusb_get_device(device.get()), which, pipes.interface, pipes.in);
  if (!in) return in.error();
  const auto out = look_at_endpoint(libusb_get_device(device.get()), which, pipes.interface, pipes.out);
  if (!out) return out.error();
  if (in->packet_bytes == 0 || pipes.transfer_bytes % in->packet_bytes != 0) {
    return no_endpoints(which, "sends packets of " + std::to_string(in->packet_bytes) +
                                   " bytes; transfers have to be a multiple of that");
  }
  static_cast<void>(libusb_set_auto_detach_kernel_driver(device.get(), 1));
  const int answer = libusb_claim_interface(device.get(), pipes.interface);
  if (answer != 0) return error{error_code::io_failed, why_not_open(which, answer)};
  auto link =
      std::make_unique<libusb_link>(std::move(*session), std::move(device), pipes, in->interrupt, out->interrupt);
  const io_status started = link->start();
  if (started != io_status::ok) {
    return error{error_code::io_failed,
                 "reading from the USB device at " + which.path + " did not start: " + to_string(started)};
  }
  return std::unique_ptr<usb_link>(std::move(link));
}

}  // namespace asperity::usb
