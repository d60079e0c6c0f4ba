// Writes HID report descriptors item by item, and those of two SpaceMice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace asperity::test_support {

/// Short items of HID 1.11 section 6.2.2.2, each value in as few bytes as hold it.
class hid_items {
 public:
  hid_items& item(std::uint8_t tag_and_type, std::int64_t value, bool has_sign) {
    std::size_t size = 4;
    if (has_sign ? value >= -128 && value <= 127 : value <= 0xff) {
      size = 1;
    } else if (has_sign ? value >= -32768 && value <= 32767 : value <= 0xffff) {
      size = 2;
    }
    bytes.push_back(static_cast<std::uint8_t>(tag_and_type | (size == 4 ? 3U : size)));
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  hid_items& page(std::uint16_t p) { return item(0x04, p, false); }
  hid_items& usage(std::uint32_t u) { return item(0x08, u, false); }
  hid_items& usages(std::uint32_t first, std::uint32_t last) {
    return item(0x18, first, false).item(0x28, last, false);
  }
  hid_items& collection(std::uint8_t kind) { return item(0xa0, kind, false); }
  hid_items& end() {
    bytes.push_back(0xc0);
    return *this;
  }
  hid_items& report(std::uint8_t id) { return item(0x84, id, false); }
  hid_items& logical(std::int32_t low, std::int32_t high) { return item(0x14, low, true).item(0x24, high, true); }
  hid_items& physical(std::int32_t low, std::int32_t high) { return item(0x34, low, true).item(0x44, high, true); }
  hid_items& unit(std::uint8_t exponent, std::uint32_t u) { return item(0x54, exponent, false).item(0x64, u, false); }
  hid_items& bits(std::uint32_t size) { return item(0x74, size, false); }
  hid_items& count(std::uint32_t n) { return item(0x94, n, false); }
  hid_items& input(std::uint8_t flags) { return item(0x80, flags, false); }
  hid_items& output(std::uint8_t flags) { return item(0x90, flags, false); }
  hid_items& feature(std::uint8_t flags) { return item(0xb0, flags, false); }

  std::vector<std::uint8_t> bytes{};
};

namespace detail {

inline void axes_of_cap(hid_items& d) {
  d.logical(-350, 350).physical(-1400, 1400).unit(0x0c, 0x11);  // 10^-4 cm
}

inline void buttons_and_light(hid_items& d) {
  d.collection(2).report(3).page(1).page(9).usages(1, 2).logical(0, 1).physical(0, 1).bits(1).count(2).input(2);
  d.count(14).input(3).end();
  d.collection(2)
      .report(4)
      .page(8)
      .usage(0x4b)
      .logical(0, 1)
      .count(1)
      .bits(1)
      .output(2)
      .count(1)
      .bits(7)
      .output(3)
      .end();
}

inline void vendor_feature(hid_items& d, std::uint8_t id, std::uint32_t usage, std::uint32_t count) {
  d.collection(2).report(id).usage(usage).count(count).feature(2).end();
}

inline void vendor_features(hid_items& d) {
  d.page(0xff00).usage(1).collection(2).logical(-128, 127).bits(8).usage(0x3a);
  for (std::uint8_t i = 0; i < 7; ++i) {
    vendor_feature(d, static_cast<std::uint8_t>(5 + i), 0x20U + i, i >= 3 && i <= 5 ? 7 : 1);
  }
  vendor_feature(d, 0x13, 0x2e, 1);
}

}  // namespace detail

/// SpaceNavigator, 046d:c626: shifts in report 1 and turns in report 2, both called relative. 217 bytes.
/// @source AndunHH/spacemouse, SpaceNavigator.md
inline std::vector<std::uint8_t> space_navigator_descriptor() {
  hid_items d;
  d.page(1).usage(8).collection(1);
  d.collection(0).report(1);
  detail::axes_of_cap(d);
  d.usage(0x30).usage(0x31).usage(0x32).bits(16).count(3).input(6).end();
  d.collection(0).report(2).usage(0x33).usage(0x34).usage(0x35).bits(16).count(3).input(6).end();
  detail::buttons_and_light(d);
  detail::vendor_features(d);
  d.end().end();
  return d.bytes;
}

/// SpaceMouse Wireless on its cable, 256f:c62e: all six axes in report 1, and a battery. 270 bytes.
/// @source AndunHH/spacemouse, SpaceMouseWireless.md
inline std::vector<std::uint8_t> spacemouse_wireless_descriptor() {
  hid_items d;
  d.page(1).usage(8).collection(1);
  d.collection(0).report(1);
  detail::axes_of_cap(d);
  for (std::uint32_t u = 0x30; u <= 0x35; ++u) d.usage(u);
  d.bits(16).count(6).input(2).end();
  detail::buttons_and_light(d);
  d.collection(2).report(0x17).logical(0, 100).unit(0, 0).page(6).usage(0x20).bits(8).count(1).input(2);
  d.logical(0, 1).page(0xff00).usage(0x27).bits(1).count(1).input(2).bits(7).input(3).end();
  detail::vendor_features(d);
  detail::vendor_feature(d, 0x19, 0x31, 4);
  detail::vendor_feature(d, 0x1a, 0x32, 7);
  d.end().end();
  return d.bytes;
}

}  // namespace asperity::test_support
