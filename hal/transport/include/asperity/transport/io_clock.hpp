// The clock for a driver's work outside a tick.
#pragma once

#include <cstdint>

namespace asperity {

/// The clock of a session, for opening, homing and arming, which wait for answers of a device. A tick is given its time
/// and never asks. Behind it is CLOCK_MONOTONIC in a real session and a number in a simulated one, so that a whole
/// handshake with a fake peer takes no real time.
class io_clock {
 public:
  io_clock() = default;
  io_clock(const io_clock&) = delete;
  io_clock& operator=(const io_clock&) = delete;
  virtual ~io_clock() = default;

  /// Session time, ns; never decreases.
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;
  /// Returns at that time or later.
  virtual void wait_until_ns(std::int64_t due_ns) noexcept = 0;
};

}  // namespace asperity
