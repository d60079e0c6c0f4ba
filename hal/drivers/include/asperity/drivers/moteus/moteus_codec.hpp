// Frames of the moteus register protocol on CAN FD: several subframes, each of which reads or writes some registers.
// Source: moteus' documents protocol/can.md and protocol/registers.md (Apache-2.0).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

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

/// What a register measures, which gives its integers their unit.
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

/// What a subframe does.
enum class action : std::uint8_t { write, read, reply, write_error, read_error };

/// Writes the subframes of one frame. What does not fit makes the whole frame unusable, and says so.
class frame_writer {
 public:
  static constexpr std::size_t capacity = 64;

  /// Begins a subframe: `count` registers from `first` on. A write or reply is followed by that many values.
  constexpr void begin(action a, resolution r, std::uint32_t count, reg first) noexcept {
    constexpr std::array<std::uint8_t, 3> base{0x00, 0x10, 0x20};
    const auto kind = static_cast<std::size_t>(a);
    if (kind >= base.size() || count == 0) {
      fits_ = false;
      return;
    }
    const auto head = static_cast<std::uint8_t>(base[kind] + 4U * static_cast<unsigned>(r));
    resolution_ = r;
    if (count <= 3) {
      put(static_cast<std::uint8_t>(head + count));
    } else {
      put(head);
      put_varuint(count);
    }
    put_varuint(static_cast<std::uint32_t>(first));
  }
  /// A value in the unit of its quantity, at most +-limit; rounded towards zero, 0 for what is not finite.
  constexpr void value(double v, quantity q, double limit = std::numeric_limits<double>::max()) noexcept {
    if (resolution_ == resolution::real) {
      put_u32(std::bit_cast<std::uint32_t>(float_toward_zero(saturated(v, limit))));
    } else {
      put_int(encode_int(v, q, resolution_, limit));
    }
  }
  /// NaN, which stands for "none" where a register knows that.
  constexpr void none() noexcept {
    if (resolution_ == resolution::real) {
      put_u32(0x7fc00000U);
    } else {
      put_int(-static_cast<std::int32_t>(most_of(resolution_)) - 1);
    }
  }
  constexpr void error(action a, reg which, std::uint32_t code) noexcept {
    put(a == action::write_error ? 0x30 : 0x31);
    put_varuint(static_cast<std::uint32_t>(which));
    put_varuint(code);
  }

  /// Fills up to a length that CAN FD has. @return the length, or 0 where something did not fit
  constexpr std::size_t finish(std::array<std::uint8_t, capacity>& out) noexcept {
    if (!fits_) return 0;
    constexpr std::array<std::size_t, 7> lengths{8, 12, 16, 20, 24, 32, 48};
    std::size_t padded = capacity;
    for (auto it = lengths.rbegin(); it != lengths.rend(); ++it) {
      if (size_ <= *it) padded = *it;
    }
    if (size_ <= 8) padded = size_;
    while (size_ < padded) put(0x50);
    out = bytes_;
    return size_;
  }

 private:
  constexpr void put(std::uint8_t b) noexcept {
    if (size_ < capacity) {
      bytes_[size_++] = b;
    } else {
      fits_ = false;
    }
  }
  constexpr void put_u32(std::uint32_t v) noexcept {
    for (unsigned i = 0; i < 4; ++i) put(static_cast<std::uint8_t>(v >> (8U * i)));
  }
  constexpr void put_int(std::int32_t v) noexcept {
    const auto bits = static_cast<std::uint32_t>(v);
    for (unsigned i = 0; i < bytes_of(resolution_); ++i) put(static_cast<std::uint8_t>(bits >> (8U * i)));
  }
  constexpr void put_varuint(std::uint32_t v) noexcept {
    for (; v > 0x7fU; v >>= 7U) put(static_cast<std::uint8_t>(v | 0x80U));
    put(static_cast<std::uint8_t>(v));
  }

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

/// Takes a frame apart, register by register. Bytes are not to be trusted: a frame that ends too early, or has an
/// unknown subframe, ends the reading with malformed(). Never more items than bytes.
class frame_reader {
 public:
  constexpr explicit frame_reader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  /// @return false at the end, and where the frame makes no sense from here on
  [[nodiscard]] constexpr bool next(item& out) noexcept {
    if (left_ == 0 && !begin(out)) return false;
    if (item_.what == action::read || item_.what == action::write_error || item_.what == action::read_error) {
      left_ = 0;
      out = item_;
      return true;
    }
    const std::size_t n = bytes_of(item_.how);
    if (bytes_.size() - at_ < n) return give_up();
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < n; ++i) bits |= static_cast<std::uint32_t>(bytes_[at_ + i]) << (8U * i);
    at_ += n;
    out = item_;
    out.whole = n == 1   ? static_cast<std::int8_t>(bits)
                : n == 2 ? static_cast<std::int16_t>(bits)
                         : static_cast<std::int32_t>(bits);
    out.real = item_.how == resolution::real ? std::bit_cast<float>(bits) : 0.0F;
    ++item_.first;
    --left_;
    return true;
  }
  [[nodiscard]] constexpr bool malformed() const noexcept { return malformed_; }

 private:
  // The head of the next subframe.
  constexpr bool begin(item&) noexcept {
    while (at_ < bytes_.size() && bytes_[at_] == 0x50) ++at_;
    if (at_ == bytes_.size()) return false;
    const std::uint8_t head = bytes_[at_++];
    item_ = {};
    if (head == 0x30 || head == 0x31) {
      item_.what = head == 0x30 ? action::write_error : action::read_error;
      left_ = 1;
      return varuint(item_.first) && varuint(item_.code);
    }
    if (head >= 0x30) return give_up();
    item_.what = head < 0x10 ? action::write : head < 0x20 ? action::read : action::reply;
    item_.how = static_cast<resolution>((head >> 2U) & 3U);
    std::uint32_t count = head & 3U;
    if (count == 0 && !varuint(count)) return false;
    if (!varuint(item_.first)) return false;
    if (count == 0) return give_up();
    left_ = count;
    item_.count = item_.what == action::read ? count : 1;
    return true;
  }
  constexpr bool varuint(std::uint32_t& out) noexcept {
    std::uint64_t v = 0;
    for (unsigned i = 0; i < 5; ++i) {
      if (at_ == bytes_.size()) return give_up();
      const std::uint8_t b = bytes_[at_++];
      v |= static_cast<std::uint64_t>(b & 0x7fU) << (7U * i);
      if ((b & 0x80U) == 0) {
        if (v > 0xffffffffU) return give_up();
        out = static_cast<std::uint32_t>(v);
        return true;
      }
    }
    return give_up();
  }
  constexpr bool give_up() noexcept {
    malformed_ = true;
    at_ = bytes_.size();
    left_ = 0;
    return false;
  }

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
[[nodiscard]] constexpr const char* to_string_fault(std::uint32_t code) noexcept {
  switch (code) {
    case 32:
      return "the drive reports a fault of its calibration";
    case 33:
      return "the drive reports a fault of its motor driver";
    case 34:
      return "the drive reports an over-voltage";
    case 35:
      return "the drive reports a fault of its encoder";
    case 36:
      return "the drive reports that its motor is not configured";
    case 37:
    case 46:
      return "the drive reports that its control loop was late";
    case 38:
      return "the drive reports an over-temperature";
    case 39:
      return "the drive reports that it started outside its position limits";
    case 40:
      return "the drive reports an under-voltage";
    case 41:
      return "the drive reports that its configuration was changed";
    case 42:
    case 43:
      return "the drive reports that it has no valid encoder";
    case 44:
      return "the drive reports that its gate driver did not start";
    case 48:
      return "the drive reports invalid position limits";
    case 49:
    case 50:
      return "the drive reports an error of control over its threshold";
    default:
      return "the drive reports a fault";
  }
}

}  // namespace asperity::moteus
