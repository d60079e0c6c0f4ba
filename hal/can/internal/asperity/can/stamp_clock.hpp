// From the kernel's stamps on the wall clock to session time, without reading a clock.
#pragma once

#include <cstdint>
#include <limits>

namespace asperity::can {

/// Wall clock and CLOCK_MONOTONIC are driven by the same ticks and corrected by the same rate, so that their difference
/// changes only when somebody sets the wall clock. Then stamps leave the span in which a frame can have arrived: after
/// the last read that found nothing, and before the read that finds it. The nearer end of the span is then the better
/// guess, and the difference is corrected by as much.
/// @rt safe
class stamp_clock {
 public:
  /// Stamps may leave the span by this much without the clock having been set: now_ns is the beginning of a tick, which
  /// can be some time ago, and a frame is stamped a little before it can be read.
  static constexpr std::int64_t slack_ns = 2'000'000;

  explicit stamp_clock(std::int64_t wall_offset_ns) noexcept : offset_ns_(wall_offset_ns) {}

  /// A read at this time found nothing.
  void empty_at(std::int64_t now_ns) noexcept { last_empty_ns_ = now_ns; }

  /// When a frame that is read at now_ns arrived, session time; never after now_ns.
  [[nodiscard]] std::int64_t session_ns(std::int64_t wall_ns, std::int64_t now_ns) noexcept {
    std::int64_t arrived_ns = wall_ns - offset_ns_;
    const bool has_empty = last_empty_ns_ != std::numeric_limits<std::int64_t>::min();
    if (arrived_ns > now_ns + slack_ns) {
      shift(arrived_ns - now_ns);
    } else if (has_empty && arrived_ns < last_empty_ns_ - slack_ns) {
      shift(arrived_ns - last_empty_ns_);
    }
    arrived_ns = wall_ns - offset_ns_;
    return arrived_ns < now_ns ? arrived_ns : now_ns;
  }

  /// How often the wall clock was found to have been set.
  [[nodiscard]] std::uint64_t steps() const noexcept { return steps_; }

 private:
  void shift(std::int64_t by_ns) noexcept {
    offset_ns_ += by_ns;
    ++steps_;
  }

  std::int64_t offset_ns_;
  std::int64_t last_empty_ns_ = std::numeric_limits<std::int64_t>::min();
  std::uint64_t steps_ = 0;
};

}  // namespace asperity::can
