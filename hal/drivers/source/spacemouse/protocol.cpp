#include "asperity/drivers/spacemouse/protocol.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace asperity {

spacemouse_format spacemouse_format::by_length() noexcept {
  spacemouse_format f;
  f.full_scale_.fill(usual_full_scale);
  f.axes_ = all_axes;
  return f;
}

spacemouse_format spacemouse_format::from(const report_descriptor& d) noexcept {
  spacemouse_format f = by_length();
  f.axes_ = no_axes;
  for (std::size_t i = 0; i < 6; ++i) {
    const hid_field* axis = d.find(hid_report_kind::input, 0x01, static_cast<std::uint16_t>(0x30 + i));
    if (axis == nullptr) continue;
    f.axis_[i] = *axis;
    f.axes_ = static_cast<axis_mask>(f.axes_ | (1U << i));
    if (axis->logical_max > 0) f.full_scale_[i] = axis->logical_max;
  }
  if (f.axes_ == no_axes) return by_length();
  f.described_ = true;
  f.numbered_ = d.numbered;
  for (const hid_field& field : d.fields) {
    if (field.kind != hid_report_kind::input || field.array) continue;
    if (field.usage_page == 0x09 && field.usage >= 1 && field.usage <= 32) {
      static_cast<void>(f.buttons_.push_back(field));
    }
  }
  if (const hid_field* b = d.find(hid_report_kind::input, 0x06, 0x20)) f.battery_ = *b;
  if (const hid_field* c = d.find(hid_report_kind::input, 0xff00, 0x27)) f.charging_ = *c;
  if (const hid_field* l = d.find(hid_report_kind::output, 0x08, 0x4b)) {
    f.light_ = *l;
    f.light_bytes_ = d.report_bytes(hid_report_kind::output, l->report_id);
  } else {
    f.light_bytes_ = 0;
  }
  return f;
}

spacemouse_decoding spacemouse_format::decode(std::span<const std::uint8_t> report,
                                              spacemouse_input& in) const noexcept {
  spacemouse_input got;
  if (report.empty()) return spacemouse_decoding::too_short;
  const spacemouse_decoding d = described_ ? decode_described(report, got) : decode_by_length(report, got);
  if (d == spacemouse_decoding::understood) in = got;
  return d;
}

std::span<const std::uint8_t> spacemouse_format::encode_light(bool on, std::span<std::uint8_t> into) const noexcept {
  if (light_bytes_ == 0 || into.size() < light_bytes_) return {};
  const std::span<std::uint8_t> report = into.first(light_bytes_);
  std::fill(report.begin(), report.end(), std::uint8_t{0});
  if (!described_) {
    report[0] = 0x04;
    report[1] = on ? 1 : 0;
    return report;
  }
  if (numbered_) report[0] = light_.report_id;
  if (!write_field(report, numbered_, light_, on ? 1 : 0)) return {};
  if (numbered_) return report;
  // A report without a number is sent with a zero in front of it.
  if (into.size() < light_bytes_ + 1) return {};
  std::copy_backward(report.begin(), report.end(), into.begin() + static_cast<std::ptrdiff_t>(light_bytes_) + 1);
  into[0] = 0;
  return into.first(light_bytes_ + 1);
}

std::int32_t spacemouse_format::int16_at(std::span<const std::uint8_t> report, std::size_t at) noexcept {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(report[at] | (report[at + 1] << 8)));
}

spacemouse_decoding spacemouse_format::decode_by_length(std::span<const std::uint8_t> report,
                                                        spacemouse_input& in) noexcept {
  const std::size_t n = report.size();
  switch (report[0]) {
    case 0x01:
    case 0x02: {
      if (n < 7) return spacemouse_decoding::too_short;
      const std::size_t first = report[0] == 0x02 ? 3 : 0;
      const std::size_t count = report[0] == 0x01 && n >= 13 ? 6 : 3;
      for (std::size_t i = 0; i < count; ++i) in.counts[first + i] = int16_at(report, 1 + 2 * i);
      in.brought = count == 6 ? all_axes : (first == 3 ? rotation_axes : translation_axes);
      return spacemouse_decoding::understood;
    }
    case 0x03:
      if (n < 2) return spacemouse_decoding::too_short;
      in.has_buttons = true;
      for (std::size_t i = 0; i < 4 && 1 + i < n; ++i) {
        in.buttons |= static_cast<std::uint32_t>(report[1 + i]) << (8 * i);
      }
      return spacemouse_decoding::understood;
    case 0x17:
      if (n < 3) return spacemouse_decoding::too_short;
      in.has_battery = true;
      in.battery_percent = std::min<std::uint8_t>(report[1], 100);
      in.charging = (report[2] & 1U) != 0;
      return spacemouse_decoding::understood;
    default:
      return spacemouse_decoding::unknown;
  }
}

spacemouse_decoding spacemouse_format::decode_described(std::span<const std::uint8_t> report,
                                                        spacemouse_input& in) const noexcept {
  const std::uint8_t id = numbered_ ? report[0] : 0;
  bool any = false;
  bool whole = true;
  const auto value = [&](const hid_field& f, std::int32_t& v) noexcept {
    if (f.bit_size == 0 || f.report_id != id) return false;
    any = true;
    const bool got = read_field(report, numbered_, f, v);
    whole = whole && got;
    return got;
  };
  std::int32_t v = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!value(axis_[i], v)) continue;
    in.counts[i] = v;
    in.brought = static_cast<axis_mask>(in.brought | (1U << i));
  }
  for (const hid_field& b : buttons_) {
    if (!value(b, v)) continue;
    in.has_buttons = true;
    if (v != 0) in.buttons |= std::uint32_t{1} << (b.usage - 1);
  }
  if (value(battery_, v)) {
    in.has_battery = true;
    in.battery_percent = static_cast<std::uint8_t>(std::clamp(v, 0, 100));
  }
  if (value(charging_, v)) in.charging = v != 0;
  if (!any) return spacemouse_decoding::unknown;
  return whole ? spacemouse_decoding::understood : spacemouse_decoding::too_short;
}

}  // namespace asperity
