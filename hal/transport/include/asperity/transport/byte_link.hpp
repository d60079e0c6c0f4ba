// The byte stream transport: a serial line, a pseudo terminal, a socket.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/transport/io_status.hpp"

namespace asperity {

/// An open stream of bytes without frames of its own. One thread at a time. Nothing here blocks, allocates or throws.
class byte_link {
 public:
  byte_link() = default;
  byte_link(const byte_link&) = delete;
  byte_link& operator=(const byte_link&) = delete;
  virtual ~byte_link() = default;

  /// Bytes that have arrived by now_ns, as many as fit. @param done how many
  /// @return ok (at least one) | nothing | gone | failed
  [[nodiscard]] virtual io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                       std::size_t& done) noexcept = 0;

  /// Hands over as many bytes as the line takes now. @param done how many
  /// @return ok (all) | too_short (some: the rest is the caller's) | busy (none) | gone | failed
  [[nodiscard]] virtual io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                        std::size_t& done) noexcept = 0;

  /// errno of the last call that failed; 0 where there is no kernel behind the link.
  [[nodiscard]] virtual int errno_value() const noexcept { return 0; }
};

}  // namespace asperity
