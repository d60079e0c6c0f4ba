#include <algorithm>
#include <charconv>
#include <fstream>
#include <linux/hid.h>
#include <string_view>
#include <system_error>

#include "asperity/hid/enumerate.hpp"

namespace asperity::hid {
namespace {

namespace fs = std::filesystem;

// The beginning of a file; empty where it cannot be read. Files here come and go with their device.
std::string head_of(const fs::path& file, std::size_t most) {
  std::ifstream in(file, std::ios::binary);
  std::string text(in ? most : 0, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(in.gcount() > 0 ? static_cast<std::size_t>(in.gcount()) : 0);
  return text;
}

std::string line_of(const fs::path& file) {
  std::string text = head_of(file, 512);
  return text.substr(0, text.find('\n'));
}

// The value behind "KEY=" in the lines of a uevent file.
std::string_view value_of(std::string_view uevent, std::string_view key) {
  while (!uevent.empty()) {
    const std::string_view line = uevent.substr(0, uevent.find('\n'));
    if (line.size() > key.size() && line.substr(0, key.size()) == key && line[key.size()] == '=') {
      return line.substr(key.size() + 1);
    }
    uevent.remove_prefix(std::min(uevent.size(), line.size() + 1));
  }
  return {};
}

bool hex(std::string_view digits, std::uint32_t& value) {
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  return fault == std::errc{} && end == digits.data() + digits.size();
}

// "0003:0000046D:0000C626": bus, vendor, product.
bool ids_of(std::string_view hid_id, hid_listing& to) {
  const std::size_t a = hid_id.find(':');
  const std::size_t b = a == std::string_view::npos ? a : hid_id.find(':', a + 1);
  if (b == std::string_view::npos) return false;
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  if (!hex(hid_id.substr(a + 1, b - a - 1), vendor) || !hex(hid_id.substr(b + 1), product)) return false;
  if (vendor > 0xffff || product > 0xffff) return false;
  to.vendor_id = static_cast<std::uint16_t>(vendor);
  to.product_id = static_cast<std::uint16_t>(product);
  return true;
}

}  // namespace

std::vector<hid_listing> list_from_sysfs(const fs::path& sys, const fs::path& dev) {
  std::vector<hid_listing> found;
  std::error_code fault;
  for (fs::directory_iterator it(sys / "class" / "hidraw", fault), end; !fault && it != end; it.increment(fault)) {
    const fs::path device = it->path() / "device";
    const std::string uevent = head_of(device / "uevent", 4096);
    hid_listing one;
    if (!ids_of(value_of(uevent, "HID_ID"), one)) continue;
    one.path = (dev / it->path().filename()).string();
    one.product = value_of(uevent, "HID_NAME");
    one.serial = value_of(uevent, "HID_UNIQ");
    const std::string descriptor = head_of(device / "report_descriptor", HID_MAX_DESCRIPTOR_SIZE);
    one.report_descriptor.assign(descriptor.begin(), descriptor.end());

    // On USB the HID device lies in its interface, and that in the device.
    std::error_code gone;
    const fs::path interface = fs::canonical(device, gone).parent_path();
    if (!gone && fs::exists(interface / "bInterfaceNumber", gone)) {
      std::uint32_t number = 0;
      if (hex(line_of(interface / "bInterfaceNumber"), number) && number < 256) {
        one.interface_number = static_cast<int>(number);
      }
      one.manufacturer = line_of(interface.parent_path() / "manufacturer");
      if (const std::string name = line_of(interface.parent_path() / "product"); !name.empty()) one.product = name;
    }
    found.push_back(std::move(one));
  }
  return found;
}

}  // namespace asperity::hid
