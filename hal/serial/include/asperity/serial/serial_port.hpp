// Serial lines and other streams of bytes of a POSIX system. Component asperity::serial.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/transport/byte_link.hpp"

namespace asperity::serial {

struct serial_settings {
  std::uint32_t bits_per_s = 115'200;  ///< any rate that the line's hardware can make, not only the usual ones
};

/// Opens a serial line, raw: 8 data bits, no parity, one stop bit, no flow control, nothing translated. Nobody else can
/// open it meanwhile, and bytes that had arrived before are discarded.
///
/// The link never blocks. A line whose adapter was unplugged, or whose other side hung up, is gone and stays so.
///
/// @return invalid_argument: no such file, or it is no terminal, or a rate of 0 | unsupported: not permitted to this
///         user, in use, or the hardware cannot make the rate | io_failed: anything else; the message says how to mend
///         it
[[nodiscard]] result<std::unique_ptr<byte_link>> open_serial(const std::string& path,
                                                             const serial_settings& settings = {});

/// Takes an open terminal or stream socket, as it is; it will not block from here on, and is closed with the link.
/// On an error it stays the caller's.
/// @return invalid_argument: not open for reading and writing, or a pipe or a file, which are no two-way streams
[[nodiscard]] result<std::unique_ptr<byte_link>> adopt_descriptor(int fd);

}  // namespace asperity::serial
