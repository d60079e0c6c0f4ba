#include "asperity/drivers/hid/report_descriptor.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace asperity {

const hid_field* report_descriptor::find(hid_report_kind kind, std::uint16_t page, std::uint16_t usage) const noexcept {
  for (const hid_field& f : fields) {
    if (f.kind == kind && f.usage_page == page && f.usage == usage && !f.array) return &f;
  }
  return nullptr;
}

std::size_t report_descriptor::report_bytes(hid_report_kind kind, std::uint8_t id) const noexcept {
  for (const hid_report_size& r : reports) {
    if (r.kind == kind && r.report_id == id) return (r.bits + 7) / 8 + (numbered ? 1 : 0);
  }
  return 0;
}

bool read_field(std::span<const std::uint8_t> report, bool numbered, const hid_field& field,
                std::int32_t& value) noexcept {
  if (field.bit_size == 0 || field.bit_size > 32) return false;
  if (field.bit_offset > report_descriptor::max_report_bits) return false;
  const std::size_t first = std::size_t{field.bit_offset} + (numbered ? 8U : 0U);
  if (first + field.bit_size > 8 * report.size()) return false;
  std::uint64_t bits = 0;
  const std::size_t byte = first / 8;
  for (std::size_t i = 0; i < 5 && byte + i < report.size(); ++i) {
    bits |= static_cast<std::uint64_t>(report[byte + i]) << (8 * i);
  }
  bits = (bits >> (first % 8)) & ((std::uint64_t{1} << field.bit_size) - 1);
  const std::uint64_t sign = std::uint64_t{1} << (field.bit_size - 1);
  if (field.logical_min < 0 && (bits & sign) != 0) bits |= ~(2 * sign - 1);
  value = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
  return true;
}

bool write_field(std::span<std::uint8_t> report, bool numbered, const hid_field& field, std::int32_t value) noexcept {
  if (field.bit_size == 0 || field.bit_size > 32) return false;
  if (field.bit_offset > report_descriptor::max_report_bits) return false;
  const std::size_t first = std::size_t{field.bit_offset} + (numbered ? 8U : 0U);
  if (first + field.bit_size > 8 * report.size()) return false;
  for (std::size_t i = 0; i < field.bit_size; ++i) {
    const std::size_t at = first + i;
    const auto mask = static_cast<std::uint8_t>(1U << (at % 8));
    const bool on = ((static_cast<std::uint32_t>(value) >> i) & 1U) != 0;
    report[at / 8] = static_cast<std::uint8_t>(on ? report[at / 8] | mask : report[at / 8] & ~mask);
  }
  return true;
}

}  // namespace asperity
