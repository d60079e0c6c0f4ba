// Waiting for a word of shared memory to change, waking who waits, and the clock of both. Linux.
#pragma once

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace asperity::plugin {

[[nodiscard]] inline std::int64_t monotonic_ns() noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
}

/// Ends when the word is not `seen` any more, somebody rings, a signal comes, or this much time is over.
/// @return false where the time is over
inline bool wait_for_change(std::atomic<std::uint32_t>& word, std::uint32_t seen, std::int64_t longest_ns) noexcept {
  static_assert(sizeof(word) == sizeof(std::uint32_t) && std::atomic<std::uint32_t>::is_always_lock_free);
  const timespec longest{.tv_sec = longest_ns / 1'000'000'000, .tv_nsec = longest_ns % 1'000'000'000};
  const long done = ::syscall(SYS_futex, &word, FUTEX_WAIT, seen, &longest, nullptr, 0);
  return done == 0 || errno != ETIMEDOUT;
}

/// Changes the word and wakes who waits for it. Never waits itself.
inline void ring(std::atomic<std::uint32_t>& word) noexcept {
  word.fetch_add(1, std::memory_order_release);
  static_cast<void>(::syscall(SYS_futex, &word, FUTEX_WAKE, 1, nullptr, nullptr, 0));
}

}  // namespace asperity::plugin
