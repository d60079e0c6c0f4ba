// Raw settings of a terminal. Apart from the rest, because the kernel's header and libc's cannot be in one file.
#pragma once

#include <cstdint>

namespace asperity::serial {

/// Makes a terminal raw: 8 data bits, no parity, one stop bit, no flow control, reads that say EAGAIN when nothing is
/// there. What has arrived is thrown away.
/// @param got_bits_per_s the rate that the hardware makes of the one asked for
/// @return 0, or an errno value
[[nodiscard]] int make_raw(int fd, std::uint32_t bits_per_s, std::uint32_t& got_bits_per_s) noexcept;

/// Keeps others from opening the terminal. @return 0, or an errno value
[[nodiscard]] int make_exclusive(int fd) noexcept;

}  // namespace asperity::serial
