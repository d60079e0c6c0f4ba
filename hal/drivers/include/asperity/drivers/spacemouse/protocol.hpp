// Reports of the SpaceMouse family: decoding and encoding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/drivers/hid/report_descriptor.hpp"

namespace asperity {

/// Values of one report.
struct spacemouse_input {
  std::array<std::int32_t, 6> counts{};  ///< displacement of the cap, device axes: x y z, then turns about them
  axis_mask brought = no_axes;           ///< the axes of `counts` that the report had
  bool has_buttons = false;
  std::uint32_t buttons = 0;  ///< button n of the device in bit n - 1
  bool has_battery = false;
  std::uint8_t battery_percent = 0;
  bool charging = false;
};

enum class spacemouse_decoding : std::uint8_t {
  understood,
  unknown,    ///< another report of the device: nothing is wrong
  too_short,  ///< ends before its values do: nothing of it was taken
};

/// Where the values are in a device's reports: from its report descriptor, or, where there is none that names an axis,
/// by the lengths that the family uses.
///
/// Two formats are in use. Classic devices send report 1 with three axes and report 2 with three turns, one after the
/// other; newer ones send report 1 with all six. All values are 16 bits with a sign. Classic descriptors call them
/// relative, which they are not: each is the whole displacement of the cap, and it repeats while the cap is held.
/// Report 3 has one bit per button, report 0x17 the battery, report 4 is the light.
/// @source descriptors and recordings published in AndunHH/spacemouse; PySpaceMouse
/// @rt decode() is safe
class ASPERITY_API spacemouse_format {
 public:
  static constexpr double usual_full_scale = 350.0;

  /// The family's own lengths and numbers.
  [[nodiscard]] static spacemouse_format by_length() noexcept;

  /// From a descriptor; by_length() where it names none of the six axes.
  [[nodiscard]] static spacemouse_format from(const report_descriptor& d) noexcept;

  /// @return too_short and unknown leave `in` as it was
  [[nodiscard]] spacemouse_decoding decode(std::span<const std::uint8_t> report, spacemouse_input& in) const noexcept;

  /// Switches the light. @return the bytes to send, number first; empty where the device has no light or `into` is too
  /// short
  [[nodiscard]] std::span<const std::uint8_t> encode_light(bool on, std::span<std::uint8_t> into) const noexcept;

  /// Whether the device's own descriptor named the axes.
  [[nodiscard]] bool described() const noexcept { return described_; }
  /// Axes that the device has.
  [[nodiscard]] axis_mask axes() const noexcept { return axes_; }
  /// Counts of an axis at full displacement; single devices go beyond it by a third.
  [[nodiscard]] double full_scale(std::size_t axis) const noexcept { return full_scale_[axis]; }
  [[nodiscard]] bool has_light() const noexcept { return light_bytes_ != 0; }

 private:
  [[nodiscard]] static std::int32_t int16_at(std::span<const std::uint8_t> report, std::size_t at) noexcept;
  [[nodiscard]] static spacemouse_decoding decode_by_length(std::span<const std::uint8_t> report,
                                                            spacemouse_input& in) noexcept;
  [[nodiscard]] spacemouse_decoding decode_described(std::span<const std::uint8_t> report,
                                                     spacemouse_input& in) const noexcept;

  bool described_ = false;
  bool numbered_ = true;
  axis_mask axes_ = no_axes;
  std::array<double, 6> full_scale_{};
  std::array<hid_field, 6> axis_{};
  fixed_vector<hid_field, 32> buttons_{};
  hid_field battery_{};
  hid_field charging_{};
  hid_field light_{};
  std::size_t light_bytes_ = 2;
};

}  // namespace asperity
