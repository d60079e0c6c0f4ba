#include <algorithm>
#include <bit>
#include <filesystem>
#include <fstream>
#include <hidapi.h>
#include <iterator>
#include <mutex>

#include "asperity/hid/enumerate.hpp"

namespace asperity::hid {
namespace {

// wchar_t holds a code point here. What is none becomes a question mark.
std::string utf8(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != L'\0'; ++text) {
    auto c = std::bit_cast<std::uint32_t>(*text);
    if (c > 0x10ffff || (c >= 0xd800 && c < 0xe000)) c = '?';
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if (c < 0x800) {
      out += static_cast<char>(0xc0 | (c >> 6));
      out += static_cast<char>(0x80 | (c & 0x3f));
    } else if (c < 0x10000) {
      out += static_cast<char>(0xe0 | (c >> 12));
      out += static_cast<char>(0x80 | ((c >> 6) & 0x3f));
      out += static_cast<char>(0x80 | (c & 0x3f));
    } else {
      out += static_cast<char>(0xf0 | (c >> 18));
      out += static_cast<char>(0x80 | ((c >> 12) & 0x3f));
      out += static_cast<char>(0x80 | ((c >> 6) & 0x3f));
      out += static_cast<char>(0x80 | (c & 0x3f));
    }
  }
  return out;
}

// hidapi has this since 0.14, and for open devices only.
std::vector<std::uint8_t> descriptor_of(const std::string& node) {
  const std::string name = std::filesystem::path(node).filename().string();
  std::ifstream in("/sys/class/hidraw/" + name + "/device/report_descriptor", std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

std::vector<hid_listing> list_from_hidapi() {
  static std::mutex one_at_a_time;  // hidapi keeps its last error in a global that it frees and sets
  const std::lock_guard lock(one_at_a_time);
  std::vector<hid_listing> found;
  // Without numbers to look for: with them, versions before 0.14 write one byte past a buffer (its issue 560).
  hid_device_info* const all = hid_enumerate(0, 0);
  for (const hid_device_info* i = all; i != nullptr; i = i->next) {
    if (i->path == nullptr) continue;
    // One entry for each usage; the node is the same.
    if (std::any_of(found.begin(), found.end(), [&](const hid_listing& l) { return l.path == i->path; })) continue;
    hid_listing one;
    one.path = i->path;
    one.vendor_id = i->vendor_id;
    one.product_id = i->product_id;
    one.serial = utf8(i->serial_number);
    one.product = utf8(i->product_string);
    one.manufacturer = utf8(i->manufacturer_string);
    one.interface_number = i->interface_number;
    one.report_descriptor = descriptor_of(one.path);
    found.push_back(std::move(one));
  }
  hid_free_enumeration(all);
  return found;
}

}  // namespace asperity::hid
