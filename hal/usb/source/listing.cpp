// Which devices there are, and what they call themselves.
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>

#include "asperity/usb/usb.hpp"
#include "handles.hpp"

namespace asperity::usb {

namespace {

std::string four_digits(std::uint16_t number) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%04x", static_cast<unsigned>(number));
  return text.data();
}

std::string vendor_and_product(const usb_listing& l) { return four_digits(l.vendor) + ":" + four_digits(l.product); }

// Printable characters of a string descriptor, which is whatever the device says.
std::string text_of(libusb_device_handle* device, std::uint8_t index) {
  std::array<unsigned char, 128> text{};
  if (index == 0) return {};
  const int size = libusb_get_string_descriptor_ascii(device, index, text.data(), static_cast<int>(text.size()));
  std::string out;
  for (int i = 0; i < size; ++i) {
    const unsigned char c = text[static_cast<std::size_t>(i)];
    if (c >= 0x20 && c < 0x7f) out += static_cast<char>(c);
  }
  return out;
}

// The kernel has read the strings as well, and shows them to everybody: a device keeps its identity where this user may
// not open it.
std::string text_from_sysfs(const std::string& path, const char* what) {
  std::ifstream file("/sys/bus/usb/devices/" + path + "/" + what);
  std::string text;
  std::getline(file, text);
  return text;
}

std::string joined(const std::string& maker, const std::string& product) {
  return maker.empty() || product.empty() ? maker + product : maker + " " + product;
}

void describe(libusb_device* device, const libusb_device_descriptor& d, usb_listing& listing) {
  libusb_device_handle* opened = nullptr;
  const int answer = libusb_open(device, &opened);
  const handle closer(opened);
  if (answer == 0) {
    listing.serial = text_of(opened, d.iSerialNumber);
    listing.name = joined(text_of(opened, d.iManufacturer), text_of(opened, d.iProduct));
    return;
  }
  listing.serial = text_from_sysfs(listing.path, "serial");
  listing.name = joined(text_from_sysfs(listing.path, "manufacturer"), text_from_sysfs(listing.path, "product"));
  listing.not_openable = why_not_open(listing, answer);
}

}  // namespace

result<context> make_context() {
  libusb_context* raw = nullptr;
  const int answer = libusb_init(&raw);
  if (answer == 0) return context(raw);
  return error{error_code::unsupported, std::string("USB cannot be used here: libusb answers '") +
                                            libusb_error_name(answer) +
                                            "'; is there a /dev/bus/usb, and may this user look into it?"};
}

std::string path_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  const std::string bus = std::to_string(libusb_get_bus_number(device));
  std::string path = count <= 0 ? "usb" : bus;  // a root hub has no ports above it
  if (count <= 0) path += bus;
  for (int i = 0; i < count; ++i) {
    path += i == 0 ? '-' : '.';
    path += std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return path;
}

std::string udev_rule(std::uint16_t vendor, std::uint16_t product) {
  return "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"" + four_digits(vendor) + "\", ATTR{idProduct}==\"" +
         four_digits(product) + "\", MODE=\"0660\", TAG+=\"uaccess\"";
}

std::string why_not_open(const usb_listing& which, int answer) {
  const std::string what = "the USB device " + vendor_and_product(which) + " at " + which.path;
  switch (answer) {
    case LIBUSB_ERROR_ACCESS:
      return "no permission to open " + what + ": write the line\n  " + udev_rule(which.vendor, which.product) +
             "\ninto /etc/udev/rules.d/70-asperity.rules, run `udevadm control --reload`, and plug the device in again";
    case LIBUSB_ERROR_BUSY:
      return what + " is in use by another program; close that one first";
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return what + " is not plugged in any more; connect it and try again";
    default:
      return what + " cannot be opened: libusb answers '" + libusb_error_name(answer) + "'; plug it in again";
  }
}

io_status status_of(int answer) noexcept {
  switch (answer) {
    case LIBUSB_SUCCESS:
      return io_status::ok;
    case LIBUSB_ERROR_NO_DEVICE:
      return io_status::gone;
    case LIBUSB_ERROR_PIPE:
    case LIBUSB_ERROR_INVALID_PARAM:
      return io_status::refused;
    default:
      return io_status::failed;
  }
}

result<std::vector<usb_listing>> list_usb(std::uint16_t vendor, std::uint16_t product) {
  const auto session = make_context();
  if (!session) return session.error();
  std::vector<usb_listing> found;
  for (libusb_device* device : device_list(session->get())) {
    libusb_device_descriptor d{};
    if (libusb_get_device_descriptor(device, &d) != 0 || d.bDeviceClass == LIBUSB_CLASS_HUB) continue;
    if ((vendor != 0 && d.idVendor != vendor) || (product != 0 && d.idProduct != product)) continue;
    usb_listing listing{
        .vendor = d.idVendor, .product = d.idProduct, .serial = {}, .path = path_of(device), .name = {}};
    describe(device, d, listing);
    found.push_back(std::move(listing));
  }
  return found;
}

}  // namespace asperity::usb
