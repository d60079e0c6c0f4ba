// Valid lengths and frames of a CAN bus.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asperity/transport/can_bus.hpp"

namespace asperity {

/// The shortest length of a CAN FD frame that holds so many bytes; 64 where none does. Classic frames hold up to 8.
/// @source ISO 11898-1:2015, table of the data length code
[[nodiscard]] constexpr std::uint8_t can_fd_length(std::size_t bytes) noexcept {
  if (bytes <= 8) return static_cast<std::uint8_t>(bytes);
  if (bytes <= 24) return static_cast<std::uint8_t>((bytes + 3) / 4 * 4);
  if (bytes <= 32) return 32;
  return bytes <= 48 ? std::uint8_t{48} : std::uint8_t{64};
}

/// The longest length below this one; 0 stays 0.
[[nodiscard]] constexpr std::uint8_t shorter_can_length(std::uint8_t size) noexcept {
  std::uint8_t shorter = size;
  while (shorter > 0 && can_fd_length(--shorter) >= size) continue;
  return size == 0 ? std::uint8_t{0} : can_fd_length(shorter);
}

/// Whether a frame can be sent: its identifier fits, its length exists, and a bus without FD is not asked for FD.
[[nodiscard]] constexpr bool is_possible(const can_frame& frame, bool fd_bus) noexcept {
  if (frame.id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) return false;
  if (!frame.fd) return frame.size <= 8 && !frame.bit_rate_switch;
  return fd_bus && !frame.remote && frame.size <= 64 && can_fd_length(frame.size) == frame.size;
}

static_assert(can_fd_length(8) == 8 && can_fd_length(9) == 12 && can_fd_length(21) == 24 && can_fd_length(25) == 32);
static_assert(can_fd_length(33) == 48 && can_fd_length(49) == 64 && can_fd_length(65) == 64);
static_assert(shorter_can_length(64) == 48 && shorter_can_length(12) == 8 && shorter_can_length(1) == 0);

}  // namespace asperity
