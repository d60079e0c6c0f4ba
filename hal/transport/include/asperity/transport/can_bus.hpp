// The CAN transport: frames out, frames in, with the time at which they came.
#pragma once

#include <array>
#include <cstdint>

#include "asperity/transport/io_status.hpp"

namespace asperity {

/// One frame of classic CAN or CAN FD.
struct can_frame {
  std::uint32_t id = 0;  ///< 11 bits, or 29 where `extended`
  bool extended = false;
  bool remote = false;           ///< asks for data and carries none; classic only
  bool fd = false;               ///< CAN FD: up to 64 bytes
  bool bit_rate_switch = false;  ///< FD only: the data is sent at the fast rate
  std::uint8_t size = 0;         ///< bytes of `data` in use: 0-8, with fd also 12 16 20 24 32 48 64
  std::array<std::uint8_t, 64> data{};
  std::int64_t host_time_ns = 0;  ///< received frames: when the kernel had it, on the session's clock

  friend bool operator==(const can_frame&, const can_frame&) = default;
};

/// State of the bus, from the controller's error frames and the socket's own counters.
struct can_health {
  bool bus_off = false;              ///< the controller has left the bus
  bool error_passive = false;        ///< close to leaving it
  std::uint8_t transmit_errors = 0;  ///< the controller's counter, where it reports one
  std::uint8_t receive_errors = 0;
  std::uint64_t lost = 0;  ///< received frames that were dropped before we read them, so far

  friend bool operator==(const can_health&, const can_health&) = default;
};

/// One CAN interface, as one program sees it: socketCAN or an in-process twin of it.
/// One thread at a time. Nothing here blocks, allocates, locks or throws.
class can_bus {
 public:
  can_bus() = default;
  can_bus(const can_bus&) = delete;
  can_bus& operator=(const can_bus&) = delete;
  virtual ~can_bus() = default;

  /// Hands a frame to the controller. ok means that it was queued, not that a node received it: a controller that is
  /// bus-off takes frames and loses them, so check health() as well.
  /// @return ok | busy | down | gone | too_short | refused | failed
  [[nodiscard]] virtual io_status send(std::int64_t now_ns, const can_frame& frame) noexcept = 0;

  /// The oldest frame that has arrived by now_ns. Error frames are not handed out: they change health(). Call it in
  /// every tick until it answers other than ok; otherwise bus-off and its end go unnoticed.
  /// @return ok | nothing | down | gone | too_short | failed; `frame` changes with ok only
  [[nodiscard]] virtual io_status receive(std::int64_t now_ns, can_frame& frame) noexcept = 0;

  /// As of the last receive().
  [[nodiscard]] virtual can_health health() const noexcept = 0;
  /// errno of the last call that failed; 0 where there is no kernel behind the bus.
  [[nodiscard]] virtual int errno_value() const noexcept { return 0; }
  /// Whether CAN FD frames can be sent.
  [[nodiscard]] virtual bool takes_fd() const noexcept = 0;
};

}  // namespace asperity
