// Records on their way from the device thread to whoever writes them down.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "asperity/control/session_record.hpp"

namespace asperity::command {

/// Single producer, single consumer, wait-free; what does not fit is left out and counted.
class record_queue {
 public:
  /// The observer's side: runs inside the device tick.
  struct writer {
    record_queue* to;
    /// The session's clock, where the ticks of a watched session are timed; otherwise null, and nothing reads a clock.
    std::int64_t (*clock_ns)() = nullptr;
    void operator()(const session_record& record) const noexcept {
      to->push(record, clock_ns != nullptr ? clock_ns() - record.time_ns : -1);
    }
  };

  /// @param took_ns from the beginning of the tick on; below 0 where nobody timed it
  /// @rt safe
  void push(const session_record& record, std::int64_t took_ns = -1) noexcept {
    const std::size_t at = written_.load(std::memory_order_relaxed);
    if (at - read_.load(std::memory_order_acquire) == capacity) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    records_[at % capacity] = record;
    took_ns_[at % capacity] = took_ns;
    written_.store(at + 1, std::memory_order_release);
  }

  /// Takes the oldest record. @return false where there is none
  bool pop(session_record& record) noexcept {
    std::int64_t unused = 0;
    return pop(record, unused);
  }
  bool pop(session_record& record, std::int64_t& took_ns) noexcept {
    const std::size_t at = read_.load(std::memory_order_relaxed);
    if (at == written_.load(std::memory_order_acquire)) return false;
    record = records_[at % capacity];
    took_ns = took_ns_[at % capacity];
    read_.store(at + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t capacity = 8192;  // eight seconds at 1 kHz

  std::array<session_record, capacity> records_{};
  std::array<std::int64_t, capacity> took_ns_{};
  alignas(64) std::atomic<std::size_t> written_{0};
  alignas(64) std::atomic<std::size_t> read_{0};
  alignas(64) std::atomic<std::uint64_t> lost_{0};
};

}  // namespace asperity::command
