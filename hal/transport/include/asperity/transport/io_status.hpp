// What a transport answers.
#pragma once

#include <cstdint>

namespace asperity {

/// Answer of one call on a transport. Nothing here blocks, so "not now" is an answer like any other.
enum class io_status : std::uint8_t {
  ok,
  nothing,    ///< nothing has arrived; not an error
  busy,       ///< the queue to the device is full: try again at a later time, not at once
  down,       ///< the link is down or bus-off, and can come back without being opened anew
  gone,       ///< unplugged or deleted: this link will never answer again
  too_short,  ///< the device or the kernel took or gave fewer bytes than a whole frame
  refused,    ///< the frame cannot be sent on this link (length, kind); nothing was sent
  failed,     ///< any other error; errno_value() of the link says more where there is a kernel behind it
};

[[nodiscard]] constexpr const char* to_string(io_status s) noexcept {
  switch (s) {
    case io_status::ok:
      return "ok";
    case io_status::nothing:
      return "nothing has arrived";
    case io_status::busy:
      return "queue is full";
    case io_status::down:
      return "link is down";
    case io_status::gone:
      return "unplugged";
    case io_status::too_short:
      return "short transfer";
    case io_status::refused:
      return "frame not possible on this link";
    case io_status::failed:
      return "transfer failed";
  }
  return "unknown answer";
}

}  // namespace asperity
