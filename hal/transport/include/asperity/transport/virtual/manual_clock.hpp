// A clock that stands still until somebody waits.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/transport/io_clock.hpp"

namespace asperity {

/// The clock of a session that exists in this process only: only waiting makes its time pass. Fake peers register
/// with it and act while it passes, so that a handshake of seconds is over in microseconds and is the same every time.
/// One thread at a time.
class ASPERITY_API manual_clock final : public io_clock {
 public:
  /// @param step_ns longest time that passes between two calls of the peers; at least 1
  explicit manual_clock(std::int64_t start_ns = 0, std::int64_t step_ns = 100'000);

  /// Calls `step` with the new time, ns, whenever time passes, in the order of registration. Called until the clock
  /// ends, and not to wait on the clock itself.
  void on_advance(std::function<void(std::int64_t)> step) { steps_.push_back(std::move(step)); }

  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }

  /// Time passes in steps until it is due_ns. A time that is over changes nothing.
  /// @rt does not allocate unless a peer does
  void wait_until_ns(std::int64_t due_ns) noexcept override;

  /// Lets that much time pass, ns.
  void advance_ns(std::int64_t passed_ns) noexcept { wait_until_ns(now_ns_ + passed_ns); }

 private:
  std::int64_t now_ns_;
  std::int64_t step_ns_;
  std::vector<std::function<void(std::int64_t)>> steps_;
};

}  // namespace asperity
