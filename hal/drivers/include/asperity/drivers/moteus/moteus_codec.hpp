// Frames of the moteus register protocol on CAN FD: several subframes, each of which reads or writes some registers.
// Source: moteus' documents protocol/can.md and protocol/registers.md (Apache-2.0).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/wire_number.hpp"

namespace asperity::moteus {

/// The registers that a joint needs.
enum class reg : std::uint32_t {
  mode = 0x000,
  position = 0x001,
  velocity = 0x002,
  torque = 0x003,
  voltage = 0x00d,
  temperature = 0x00e,
  fault = 0x00f,
  command_position = 0x020,
  command_velocity = 0x021,
  feedforward_torque = 0x022,
  kp_scale = 0x023,
  kd_scale = 0x024,
  maximum_torque = 0x025,
  watchdog_timeout = 0x027,
  integral_scale = 0x02b,
  firmware_version = 0x101,
  register_map_version = 0x102,
};

enum class mode : std::uint8_t {
  stopped = 0,
  fault = 1,
  enabling = 2,
  calibrating = 3,
  calibrated = 4,
  position = 10,
  timeout = 11,
  zero_velocity = 12,
  brake = 15,
};

/// How a value is written: an integer whose unit depends on what it measures, or a float in the base unit.
enum class resolution : std::uint8_t { int8 = 0, int16 = 1, int32 = 2, real = 3 };

/// The quantity of a register, which decides the unit of its integers.
enum class quantity : std::uint8_t {
  plain,
  torque_n_m,
  voltage_v,
  temperature_c,
  time_s,
  position_rev,
  velocity_rev_per_s,
  scale
};

[[nodiscard]] constexpr std::size_t bytes_of(resolution r) noexcept {
  constexpr std::array<std::size_t, 4> bytes{1, 2, 4, 4};
  return bytes[static_cast<std::size_t>(r)];
}

/// Largest magnitude of an integer; the value below its negative stands for NaN.
[[nodiscard]] constexpr double most_of(resolution r) noexcept {
  constexpr std::array<double, 4> most{127.0, 32767.0, 2147483647.0, 0.0};
  return most[static_cast<std::size_t>(r)];
}

/// Unit of an integer.
[[nodiscard]] constexpr double unit_of(quantity q, resolution r) noexcept {
  const auto of = [r](double in8, double in16, double in32) {
    return r == resolution::int8 ? in8 : r == resolution::int16 ? in16 : r == resolution::int32 ? in32 : 1.0;
  };
  switch (q) {
    case quantity::plain:
      return 1.0;
    case quantity::torque_n_m:
      return of(0.5, 0.01, 0.001);
    case quantity::voltage_v:
      return of(0.5, 0.1, 0.001);
    case quantity::temperature_c:
      return of(1.0, 0.1, 0.001);
    case quantity::time_s:
      return of(0.01, 0.001, 0.000001);
    case quantity::position_rev:
      return of(0.01, 0.0001, 0.00001);
    case quantity::velocity_rev_per_s:
      return of(0.1, 0.00025, 0.00001);
    case quantity::scale:
      return of(1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0);
  }
  return 1.0;
}

/// A value as the wire's integer: rounded towards zero, within the integer's range and +-limit; 0 for what is not
/// finite.
/// @pre r is not real; limit >= 0
[[nodiscard]] constexpr std::int32_t encode_int(double value, quantity q, resolution r, double limit) noexcept {
  return static_cast<std::int32_t>(wire_count(saturated(value, limit), unit_of(q, r), most_of(r)));
}

/// Kind of a subframe.
enum class action : std::uint8_t { write, read, reply, write_error, read_error };

/// Writes the subframes of one frame. What does not fit makes the whole frame unusable, and says so.
class ASPERITY_API frame_writer {
 public:
  static constexpr std::size_t capacity = 64;

  /// Begins a subframe: `count` registers from `first` on. A write or reply is followed by that many values.
  void begin(action a, resolution r, std::uint32_t count, reg first) noexcept;
  /// A value in the unit of its quantity, at most +-limit; rounded towards zero, 0 for what is not finite.
  void value(double v, quantity q, double limit = std::numeric_limits<double>::max()) noexcept;
  /// NaN, which stands for "none" where a register knows that.
  void none() noexcept;
  void error(action a, reg which, std::uint32_t code) noexcept;

  /// Fills up to a length that CAN FD has. @return the length, or 0 where something did not fit
  std::size_t finish(std::array<std::uint8_t, capacity>& out) noexcept;

 private:
  void put(std::uint8_t b) noexcept;
  void put_u32(std::uint32_t v) noexcept;
  void put_int(std::int32_t v) noexcept;
  void put_varuint(std::uint32_t v) noexcept;

  std::array<std::uint8_t, capacity> bytes_{};
  std::size_t size_ = 0;
  resolution resolution_ = resolution::int8;
  bool fits_ = true;
};

/// One register of a subframe. A read has no value, and stands once for all of its registers.
struct item {
  action what = action::reply;
  resolution how = resolution::int8;
  std::uint32_t first = 0;  ///< the register
  std::uint32_t count = 1;  ///< registers of a read; otherwise 1
  std::uint32_t code = 0;   ///< of an error
  std::int32_t whole = 0;   ///< of an integer
  float real = 0.0F;

  [[nodiscard]] constexpr bool is(reg r) const noexcept { return first == static_cast<std::uint32_t>(r); }
  /// The value in the unit of `q`; NaN where the wire says "none".
  [[nodiscard]] constexpr double value(quantity q) const noexcept {
    if (how == resolution::real) return static_cast<double>(real);
    if (static_cast<double>(whole) < -most_of(how)) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(whole) * unit_of(q, how);
  }
};

/// Takes a frame apart, register by register. Its bytes are not trusted: a frame that ends too early, or has an
/// unknown subframe, ends the reading with malformed(). Never more items than bytes.
class ASPERITY_API frame_reader {
 public:
  constexpr explicit frame_reader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  /// @return false at the end, and where the frame makes no sense from here on
  [[nodiscard]] bool next(item& out) noexcept;
  [[nodiscard]] constexpr bool malformed() const noexcept { return malformed_; }

 private:
  // The head of the next subframe.
  bool begin(item&) noexcept;
  bool varuint(std::uint32_t& out) noexcept;
  bool give_up() noexcept;

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::uint32_t left_ = 0;  // values that the subframe still has
  item item_{};
  bool malformed_ = false;
};

/// Id of a frame from one address to another; both 0-127.
[[nodiscard]] constexpr std::uint32_t frame_id(std::uint32_t from, std::uint32_t to, bool wants_reply) noexcept {
  return (from & 0x7fU) << 8U | (to & 0x7fU) | (wants_reply ? 0x8000U : 0U);
}

/// A fault code in words.
[[nodiscard]] ASPERITY_API const char* to_string_fault(std::uint32_t code) noexcept;

}  // namespace asperity::moteus
