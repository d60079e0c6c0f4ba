// The layout of a HID device's reports, from the device's own description.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"

namespace asperity {

enum class hid_report_kind : std::uint8_t { input, output, feature };

/// One value in a report: where its bits are and what they mean.
struct hid_field {
  hid_report_kind kind = hid_report_kind::input;
  std::uint8_t report_id = 0;  ///< 0 where the device numbers none
  std::uint16_t usage_page = 0;
  std::uint16_t usage = 0;
  std::uint32_t bit_offset = 0;  ///< from the first bit after the report's number
  std::uint32_t bit_size = 0;    ///< 1-32
  std::int32_t logical_min = 0;  ///< negative: the value has a sign
  std::int32_t logical_max = 0;
  std::int32_t physical_min = 0;  ///< as the logical range where the device gives none
  std::int32_t physical_max = 0;
  std::uint32_t unit = 0;         ///< HID 1.11 section 6.2.2.7
  std::int8_t unit_exponent = 0;  ///< power of ten
  bool relative = false;          ///< a change since the last report, as the device claims
  bool array = false;             ///< the value is an index of a usage, and `usage` is the lowest of them
  std::uint16_t top_page = 0;     ///< usage page of the application collection it is in
  std::uint16_t top_usage = 0;
};

/// Length of one report.
struct hid_report_size {
  hid_report_kind kind = hid_report_kind::input;
  std::uint8_t report_id = 0;
  std::uint32_t bits = 0;  ///< without the number
};

/// Result of parsing a descriptor.
enum class descriptor_status : std::uint8_t {
  ok,
  empty,       ///< no bytes
  cut_off,     ///< ends inside an item
  bad_item,    ///< a reserved item, or a value that makes no sense where it stands
  unbalanced,  ///< collections or pushes that do not close
  too_large,   ///< longer, deeper or with longer reports than the limits below
  capacity,    ///< the fields that fit are there; `fields.dropped()` says how many did not
};

[[nodiscard]] constexpr const char* to_string(descriptor_status s) noexcept {
  switch (s) {
    case descriptor_status::ok:
      return "ok";
    case descriptor_status::empty:
      return "empty";
    case descriptor_status::cut_off:
      return "ends inside an item";
    case descriptor_status::bad_item:
      return "has an item that makes no sense";
    case descriptor_status::unbalanced:
      return "has a collection or a push that does not close";
    case descriptor_status::too_large:
      return "is larger than a report descriptor can be";
    case descriptor_status::capacity:
      return "has more fields than there is room for";
  }
  return "unknown status";
}

/// A parsed report descriptor, of any bytes whatever: memory and time are bounded, nothing is allocated.
/// Fields that were parsed before a fault are dropped: with any status but ok and capacity there are none.
/// @source HID 1.11, sections 5 and 6.2.2
struct ASPERITY_API report_descriptor {
  static constexpr std::size_t max_bytes = 4096;            ///< as in the kernel
  static constexpr std::uint32_t max_report_bits = 131072;  ///< as in the kernel
  static constexpr std::size_t max_fields = 192;
  static constexpr std::size_t max_reports = 48;

  fixed_vector<hid_field, max_fields> fields{};
  fixed_vector<hid_report_size, max_reports> reports{};
  bool numbered = false;  ///< every report begins with its number
  descriptor_status status = descriptor_status::empty;

  /// The first field with this usage, or null.
  [[nodiscard]] const hid_field* find(hid_report_kind kind, std::uint16_t page, std::uint16_t usage) const noexcept;

  /// Bytes of a report on the wire, its number included; 0 where there is no such report.
  [[nodiscard]] std::size_t report_bytes(hid_report_kind kind, std::uint8_t id) const noexcept;
};

/// Parses the bytes of a report descriptor. The result takes some 10 KB: not for a small stack, and not inside a tick.
[[nodiscard]] ASPERITY_API report_descriptor parse_report_descriptor(std::span<const std::uint8_t> bytes) noexcept;

/// Bits of a field out of a report. The report's bytes are hostile: false where they end before the field does, and
/// `value` is then unchanged. The value may lie outside the logical range.
/// @param report with its number, where reports are numbered
/// @rt safe
[[nodiscard]] ASPERITY_API bool read_field(std::span<const std::uint8_t> report, bool numbered, const hid_field& field,
                                           std::int32_t& value) noexcept;

/// Sets the bits of a field in a report, where the report is long enough for it. @return whether it is
/// @rt safe
ASPERITY_API bool write_field(std::span<std::uint8_t> report, bool numbered, const hid_field& field,
                              std::int32_t value) noexcept;

}  // namespace asperity
