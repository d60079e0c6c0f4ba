// The sixteen bytes that go to a Novint Falcon and come back from it.
//
// Both ways a frame is '<', fourteen bytes and '>'. A byte in between is a number plus 0x41, so that neither bracket
// can stand there: twelve hold three 16-bit integers, four bits each, the lowest four first; the thirteenth holds
// flags. There is no checksum. Source: the published protocol facts of libnifalcon (docs/bibliography.md); nothing here
// was tried on a device.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace asperity {

inline constexpr std::size_t falcon_frame_size = 16;
using falcon_frame = std::array<std::uint8_t, falcon_frame_size>;

/// Largest number that a motor is ever sent, counts. Published sources name it as the cap of the firmware.
inline constexpr std::int16_t falcon_counts_limit = 4096;

/// Lights of the ring, one bit each.
enum class falcon_light : std::uint8_t { none = 0, green = 2, blue = 4, red = 8 };

/// What a Falcon is told.
struct falcon_command {
  std::array<std::int16_t, 3> motor_counts{};  ///< of the motors' torque; saturated when it is encoded
  falcon_light light = falcon_light::none;
  bool home = false;  ///< asks the firmware to watch for the legs' index marks

  friend bool operator==(const falcon_command&, const falcon_command&) = default;
};

/// What a Falcon answers.
struct falcon_report {
  std::array<std::int16_t, 3> encoder_counts{};
  std::uint8_t buttons = 0;  ///< plus (right) 1, forward 2, centre 4, minus (left) 8
  std::uint8_t homed = 0;    ///< one bit per leg; 7 where all have passed their index mark

  friend bool operator==(const falcon_report&, const falcon_report&) = default;
};
inline constexpr std::uint8_t falcon_all_homed = 7;

/// Counts of one motor from any number: rounded to the nearest, saturated, 0 for NaN. The sign is never another one.
/// @rt safe
[[nodiscard]] constexpr std::int16_t falcon_motor_counts(double counts) noexcept {
  if (counts != counts) return 0;
  constexpr double limit = falcon_counts_limit;
  const double bounded = counts < -limit ? -limit : (counts > limit ? limit : counts);
  return static_cast<std::int16_t>(bounded + (bounded < 0.0 ? -0.5 : 0.5));
}

namespace falcon_detail {

inline constexpr std::uint8_t base = 0x41;
inline constexpr std::uint8_t opening = 0x3c;
inline constexpr std::uint8_t closing = 0x3e;

constexpr void put_word(std::int16_t word, std::span<std::uint8_t, 4> bytes) noexcept {
  const auto bits = static_cast<std::uint16_t>(word);
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(base + ((bits >> (4 * i)) & 0xf));
}

// Nothing where a byte is not one of the sixteen that a number can have.
[[nodiscard]] constexpr std::optional<std::int16_t> get_word(std::span<const std::uint8_t, 4> bytes) noexcept {
  std::uint16_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (bytes[i] < base || bytes[i] > base + 0xf) return std::nullopt;
    bits = static_cast<std::uint16_t>(bits | ((bytes[i] - base) << (4 * i)));
  }
  return static_cast<std::int16_t>(bits);
}

[[nodiscard]] constexpr std::int16_t within_limit(std::int16_t counts) noexcept {
  constexpr auto limit = falcon_counts_limit;
  if (counts > limit) return limit;
  return counts < -limit ? static_cast<std::int16_t>(-limit) : counts;
}

}  // namespace falcon_detail

/// The bytes of a command. Counts beyond the limit become the limit, whoever asks.
/// @rt safe
[[nodiscard]] constexpr falcon_frame encode_falcon(const falcon_command& command) noexcept {
  namespace d = falcon_detail;
  falcon_frame bytes{};
  bytes[0] = d::opening;
  for (std::size_t i = 0; i < 3; ++i) {
    d::put_word(d::within_limit(command.motor_counts[i]), std::span(bytes).subspan(1 + 4 * i).first<4>());
  }
  const unsigned flags = (static_cast<unsigned>(command.light) & 0xeU) | (command.home ? 1U : 0U);
  bytes[13] = static_cast<std::uint8_t>(d::base + flags);
  bytes[14] = d::base;
  bytes[15] = d::closing;
  return bytes;
}

/// The command in a frame, as a device reads it; nothing where it is no frame of a command.
/// @rt safe
[[nodiscard]] constexpr std::optional<falcon_command> decode_falcon_command(const falcon_frame& bytes) noexcept {
  namespace d = falcon_detail;
  if (bytes[0] != d::opening || bytes[15] != d::closing) return std::nullopt;
  if (bytes[13] < d::base || bytes[13] > d::base + 0xf || bytes[14] < d::base) return std::nullopt;
  falcon_command command;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto word = d::get_word(std::span(bytes).subspan(1 + 4 * i).first<4>());
    if (!word) return std::nullopt;
    command.motor_counts[i] = *word;
  }
  const unsigned flags = bytes[13] - unsigned{d::base};
  command.light = static_cast<falcon_light>(flags & 0xeU);
  command.home = (flags & 1U) != 0;
  return command;
}

/// The report in a frame; nothing where it is no frame of a report. The fourteenth byte has no known meaning.
/// @rt safe
[[nodiscard]] constexpr std::optional<falcon_report> decode_falcon_report(const falcon_frame& bytes) noexcept {
  namespace d = falcon_detail;
  if (bytes[0] != d::opening || bytes[15] != d::closing) return std::nullopt;
  if (bytes[13] < d::base || bytes[13] > d::base + 0x7f || bytes[14] < d::base) return std::nullopt;
  falcon_report report;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto word = d::get_word(std::span(bytes).subspan(1 + 4 * i).first<4>());
    if (!word) return std::nullopt;
    report.encoder_counts[i] = *word;
  }
  const unsigned flags = bytes[13] - unsigned{d::base};
  report.buttons = static_cast<std::uint8_t>(flags & 0xfU);
  report.homed = static_cast<std::uint8_t>(flags >> 4U);
  return report;
}

/// The bytes of a report, as a device writes it.
[[nodiscard]] constexpr falcon_frame encode_falcon_report(const falcon_report& report) noexcept {
  namespace d = falcon_detail;
  falcon_frame bytes{};
  bytes[0] = d::opening;
  for (std::size_t i = 0; i < 3; ++i) {
    d::put_word(report.encoder_counts[i], std::span(bytes).subspan(1 + 4 * i).first<4>());
  }
  const unsigned flags = (report.buttons & 0xfU) | ((report.homed & 7U) << 4U);
  bytes[13] = static_cast<std::uint8_t>(d::base + flags);
  bytes[14] = d::base;
  bytes[15] = d::closing;
  return bytes;
}

/// Finds frames in a stream of bytes that may begin anywhere, lose some and hold others. An opening bracket begins a
/// frame wherever it stands, so that at most the frame in which bytes are missing is lost.
/// @rt safe
class falcon_deframer {
 public:
  /// Takes the next byte. @return the frame that it completes, of the right length and brackets
  [[nodiscard]] std::optional<falcon_frame> push(std::uint8_t byte) noexcept {
    if (byte == falcon_detail::opening) {
      if (size_ != 0) ++broken_;
      bytes_[0] = byte;
      size_ = 1;
      return std::nullopt;
    }
    if (size_ == 0) return std::nullopt;
    bytes_[size_++] = byte;
    const bool full = size_ == falcon_frame_size;
    if (!full && byte != falcon_detail::closing) return std::nullopt;
    size_ = 0;
    if (full && byte == falcon_detail::closing) return bytes_;
    ++broken_;
    return std::nullopt;
  }

  /// Forgets a frame that has begun.
  void restart() noexcept { size_ = 0; }
  /// Frames that began and never ended as they should.
  [[nodiscard]] std::uint64_t broken() const noexcept { return broken_; }

 private:
  falcon_frame bytes_{};
  std::size_t size_ = 0;
  std::uint64_t broken_ = 0;
};

}  // namespace asperity
