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

#include "asperity/core/export.hpp"

namespace asperity {

inline constexpr std::size_t falcon_frame_size = 16;
using falcon_frame = std::array<std::uint8_t, falcon_frame_size>;

/// Largest number that is ever sent to a motor, counts. Published sources name it as the cap of the firmware.
inline constexpr std::int16_t falcon_counts_limit = 4096;

/// Lights of the ring, one bit each.
enum class falcon_light : std::uint8_t { none = 0, green = 2, blue = 4, red = 8 };

/// A command to a Falcon.
struct falcon_command {
  std::array<std::int16_t, 3> motor_counts{};  ///< of the motors' torque; saturated when it is encoded
  falcon_light light = falcon_light::none;
  bool home = false;  ///< asks the firmware to watch for the legs' index marks

  friend bool operator==(const falcon_command&, const falcon_command&) = default;
};

/// A report of a Falcon.
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

/// The bytes of a command. Counts beyond the limit become the limit.
/// @rt safe
[[nodiscard]] ASPERITY_API falcon_frame encode_falcon(const falcon_command& command) noexcept;

/// The command in a frame, as a device reads it; nothing where it is no frame of a command.
/// @rt safe
[[nodiscard]] ASPERITY_API std::optional<falcon_command> decode_falcon_command(const falcon_frame& bytes) noexcept;

/// The report in a frame; nothing where it is no frame of a report. The fourteenth byte has no known meaning.
/// @rt safe
[[nodiscard]] ASPERITY_API std::optional<falcon_report> decode_falcon_report(const falcon_frame& bytes) noexcept;

/// The bytes of a report, as a device writes it.
[[nodiscard]] ASPERITY_API falcon_frame encode_falcon_report(const falcon_report& report) noexcept;

/// Finds frames in a stream of bytes that may begin anywhere, lose some and hold others. An opening bracket begins a
/// frame wherever it stands, so that at most the frame in which bytes are missing is lost.
/// @rt safe
class ASPERITY_API falcon_deframer {
 public:
  /// Takes the next byte. @return the frame that it completes, of the right length and brackets
  [[nodiscard]] std::optional<falcon_frame> push(std::uint8_t byte) noexcept;

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
