// How long a frame occupies a CAN bus.
#pragma once

#include <cstdint>

#include "asperity/transport/can_bus.hpp"

namespace asperity {

/// Bit rates of a bus, bit/s.
struct can_bit_rates {
  std::uint32_t nominal_per_s = 1'000'000;  ///< of classic frames, and of the ends of FD frames; above 0
  std::uint32_t data_per_s = 5'000'000;     ///< of the middle of FD frames with bit_rate_switch; above 0
};

/// The longest that a frame can hold the bus, ns, the pause after it included: as many stuff bits as any data can need.
/// A bus that is to carry frames in every tick carries them only if the sum of these is below the tick's period, with
/// room for what is sent besides; a frame that was lost is sent again by itself.
/// @pre the frame is possible: see is_possible()
/// @source ISO 11898-1:2015, frame formats; for classic frames the bound of Davis et al., Real-Time Systems 35, 2007
[[nodiscard]] constexpr std::int64_t longest_time_ns(const can_frame& frame, const can_bit_rates& rates) noexcept {
  constexpr std::int64_t second_ns = 1'000'000'000;
  constexpr std::int64_t end_bits = 13;  // CRC delimiter, acknowledgement, end of frame, intermission
  const std::int64_t data_bits = frame.remote ? 0 : 8 * std::int64_t{frame.size};
  // After five equal bits one is stuffed, which may be the first of the next five.
  const auto most_stuffed = [](std::int64_t bits) { return (bits - 1) / 4; };
  const auto time_ns = [](std::int64_t bits, std::uint32_t rate) {
    return (bits * second_ns + rate - 1) / std::int64_t{rate};
  };

  if (!frame.fd) {
    const std::int64_t stuffed_over = (frame.extended ? 54 : 34) + data_bits;  // up to the end of the CRC
    return time_ns(stuffed_over + most_stuffed(stuffed_over) + end_bits, rates.nominal_per_s);
  }
  const std::int64_t head_bits = frame.extended ? 36 : 17;  // up to the bit that switches the rate
  const std::int64_t control_bits = 5;                      // error state, length code
  // Count of stuff bits, CRC and their own fixed stuff bits.
  const std::int64_t check_bits = frame.size <= 16 ? 4 + 17 + 6 : 4 + 21 + 7;
  const std::int64_t head = head_bits + most_stuffed(head_bits);
  const std::int64_t middle = control_bits + data_bits + most_stuffed(head_bits + control_bits + data_bits) -
                              most_stuffed(head_bits) + check_bits;
  return time_ns(head + end_bits, rates.nominal_per_s) +
         time_ns(middle, frame.bit_rate_switch ? rates.data_per_s : rates.nominal_per_s);
}

}  // namespace asperity
