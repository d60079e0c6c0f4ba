// The kit's session clock.
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace asperity::conformance {

/// A number for a device that is made of numbers, CLOCK_MONOTONIC for one that is made of metal.
class kit_clock {
 public:
  explicit kit_clock(bool real) noexcept : real_(real) {}

  [[nodiscard]] std::int64_t now_ns() const noexcept { return real_ ? monotonic_ns() : virtual_ns_; }
  void wait_ns(std::int64_t duration_ns) noexcept {
    if (!real_) {
      virtual_ns_ += duration_ns;
      return;
    }
    // Deadlines follow each other, so that a late wake-up does not make all later ones late.
    const std::int64_t now = monotonic_ns();
    due_ns_ = due_ns_ + duration_ns > now ? due_ns_ + duration_ns : now + duration_ns / 2;
    const timespec due{.tv_sec = due_ns_ / 1'000'000'000, .tv_nsec = due_ns_ % 1'000'000'000};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
    }
  }
  [[nodiscard]] bool real() const noexcept { return real_; }

  [[nodiscard]] static std::int64_t monotonic_ns() noexcept {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
  }

 private:
  bool real_;
  std::int64_t virtual_ns_ = 1'000'000'000;
  std::int64_t due_ns_ = 0;
};

}  // namespace asperity::conformance
