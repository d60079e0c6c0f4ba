// Frames of the MIT mini-cheetah protocol, which CubeMars (T-Motor) AK actuators speak as "MIT mode".
// Source: B. Katz, motorcontrol firmware (MIT licence); ranges and error codes of the AK series as public drivers give
// them; its manual was not at hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/wire_number.hpp"

namespace asperity::mit {

/// Values at the ends of the wire's integers: +-position, +-velocity, +-torque of the output shaft. Drive and host
/// have to agree on them: a wrong table scales every torque.
struct ASPERITY_API ranges {
  double position_rad = 12.5;
  double velocity_rad_per_s = 50.0;
  double torque_n_m = 18.0;
  double stiffness_n_m_per_rad = 500.0;
  double damping_n_m_s_per_rad = 5.0;

  [[nodiscard]] bool usable() const noexcept;
};

inline constexpr ranges ak80_9{.velocity_rad_per_s = 50.0, .torque_n_m = 18.0};
inline constexpr ranges ak10_9{.velocity_rad_per_s = 50.0, .torque_n_m = 65.0};
inline constexpr ranges ak60_6{.velocity_rad_per_s = 50.0, .torque_n_m = 15.0};
inline constexpr ranges ak70_10{.velocity_rad_per_s = 50.0, .torque_n_m = 25.0};
inline constexpr ranges ak80_6{.velocity_rad_per_s = 76.0, .torque_n_m = 12.0};
inline constexpr ranges ak80_64{.velocity_rad_per_s = 8.0, .torque_n_m = 144.0};

/// A number within +-range as an unsigned integer of 12 or 16 bits. The integers are even in number, so that none of
/// them is zero: they stand for the odd multiples of range / (2^bits - 1), and 0 becomes the one just below it.
/// Rounds towards zero, down to the smallest value of the right sign.
class symmetric_field {
 public:
  /// @param limit nothing is encoded that decodes to more than that, in double or in the drive's float.
  /// @pre range > 0; limit >= range / (2^bits - 1); bits <= 16
  constexpr symmetric_field(double range, unsigned bits, double limit) noexcept : symmetric_field(range, bits) {
    const auto over = [&](int n) {
      return magnitude(n) > limit || static_cast<double>(drive_value(middle() + n)) > limit ||
             -static_cast<double>(drive_value(middle() - 1 - n)) > limit;
    };
    while (most_ > 0 && over(most_)) --most_;
  }
  constexpr symmetric_field(double range, unsigned bits) noexcept
      : range_(range),
        top_(static_cast<int>((1U << bits) - 1U)),
        most_(top_ / 2),
        half_step_(range / static_cast<double>(top_)),
        per_step_(static_cast<double>(top_) / (2.0 * range)) {}

  /// What is not finite is 0.
  [[nodiscard]] constexpr std::uint16_t encode(double value) const noexcept {
    const double wanted = saturated(value, range_);
    const double size = wanted < 0.0 ? -wanted : wanted;
    const double steps = size * per_step_ - 0.5;
    int n = steps > 0.0 ? static_cast<int>(steps) : 0;
    n -= n > 0 && half_step_ * static_cast<double>(2 * n + 1) > size ? 1 : 0;
    n = n < most_ ? n : most_;
    return static_cast<std::uint16_t>(wanted > 0.0 ? middle() + n : middle() - 1 - n);
  }
  [[nodiscard]] constexpr double decode(std::uint16_t wire) const noexcept {
    return range_ * static_cast<double>(2 * static_cast<int>(wire) - top_) / static_cast<double>(top_);
  }

  /// Half the distance of two values: what is lost at most, and what a zero decodes to, with a minus.
  [[nodiscard]] constexpr double half_step() const noexcept { return half_step_; }
  /// The largest value that is ever encoded.
  [[nodiscard]] constexpr double largest() const noexcept { return magnitude(most_); }

 private:
  // Smallest integer of a positive value.
  [[nodiscard]] constexpr int middle() const noexcept { return top_ / 2 + 1; }
  [[nodiscard]] constexpr double magnitude(int n) const noexcept {
    return range_ * static_cast<double>(2 * n + 1) / static_cast<double>(top_);
  }
  // As the firmware computes it, in float.
  [[nodiscard]] constexpr float drive_value(int wire) const noexcept {
    const auto low = static_cast<float>(-range_);
    const float span = static_cast<float>(range_) - low;
    return static_cast<float>(wire) * span / static_cast<float>(top_) + low;
  }

  double range_;
  int top_;
  int most_;  // steps from the middle that the limit allows
  double half_step_;
  double per_step_;
};

/// A command to a drive, which puts out stiffness (position - its own) + damping (velocity - its own) + torque.
struct command {
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double stiffness_n_m_per_rad = 0.0;
  double damping_n_m_s_per_rad = 0.0;
  double torque_n_m = 0.0;
};

using command_bytes = std::array<std::uint8_t, 8>;

/// The three frames that are not commands: all bytes are 0xff but the last, which says which it is.
inline constexpr command_bytes enter_motor_mode{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc};
inline constexpr command_bytes exit_motor_mode{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfd};
inline constexpr command_bytes set_zero_position{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe};

/// A gain between 0 and `most`, rounded down; what is not finite or negative is 0.
[[nodiscard]] constexpr std::uint16_t encode_gain(double value, double most) noexcept {
  return static_cast<std::uint16_t>(wire_count(value > 0.0 ? value : 0.0, most / 4095.0, 4095.0));
}

/// Packs position (16 bits), velocity, stiffness, damping and torque (12 bits each), most significant bit first.
/// A command that would read as one of the three special frames loses its last steps of torque.
[[nodiscard]] constexpr command_bytes encode(const command& c, const ranges& r,
                                             const symmetric_field& torque) noexcept {
  const std::uint32_t p = symmetric_field(r.position_rad, 16).encode(c.position_rad);
  const std::uint32_t v = symmetric_field(r.velocity_rad_per_s, 12).encode(c.velocity_rad_per_s);
  const std::uint32_t kp = encode_gain(c.stiffness_n_m_per_rad, r.stiffness_n_m_per_rad);
  const std::uint32_t kd = encode_gain(c.damping_n_m_s_per_rad, r.damping_n_m_s_per_rad);
  const std::uint32_t t = torque.encode(c.torque_n_m);
  const auto byte = [](std::uint32_t x) { return static_cast<std::uint8_t>(x & 0xffU); };
  command_bytes b{byte(p >> 8U),
                  byte(p),
                  byte(v >> 4U),
                  byte((v & 0xfU) << 4U | kp >> 8U),
                  byte(kp),
                  byte(kd >> 4U),
                  byte((kd & 0xfU) << 4U | t >> 8U),
                  byte(t)};
  bool special = b[7] >= 0xfc;
  for (std::size_t i = 0; i < 7; ++i) special = special && b[i] == 0xff;
  if (special) b[7] = 0xfb;
  return b;
}

/// Torque alone: no stiffness, no damping.
[[nodiscard]] constexpr command_bytes encode_torque(double torque_n_m, const ranges& r,
                                                    const symmetric_field& torque) noexcept {
  return encode({.torque_n_m = torque_n_m}, r, torque);
}

/// What a drive reads in a command that is not a special frame.
[[nodiscard]] ASPERITY_API command decode_command(const command_bytes& b, const ranges& r) noexcept;

/// A drive's answer to every frame. Three lengths are in use: 6 bytes; 7 with the supply voltage (motorcontrol);
/// 8 with temperature and error code (AK).
struct reply {
  std::uint8_t id = 0;
  std::uint16_t position_counts = 0;  ///< wraps: 65536 counts are a turn over both ends of the range
  double velocity_rad_per_s = 0.0;
  double torque_n_m = 0.0;
  std::uint8_t size = 6;
  std::uint8_t error = 0;           ///< 8 bytes only; 0 is none
  std::uint8_t temperature_c = 0;   ///< 8 bytes only
  std::uint8_t voltage_counts = 0;  ///< 7 bytes only; the range is the firmware's
};

/// @return false where the length is none of the three; `out` changes with true only
[[nodiscard]] ASPERITY_API bool decode_reply(std::span<const std::uint8_t> b, const ranges& r, reply& out) noexcept;

/// The drive's side. @return bytes of `b` in use, which is r.size
[[nodiscard]] ASPERITY_API std::size_t encode_reply(const reply& a, const ranges& r, command_bytes& b) noexcept;

/// An error code of the AK series in words. Code 6 has two meanings, by firmware.
[[nodiscard]] ASPERITY_API const char* to_string_error(std::uint8_t code) noexcept;

}  // namespace asperity::mit
