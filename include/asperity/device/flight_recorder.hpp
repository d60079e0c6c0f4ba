// The last moments before a fault.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/core/spatial.hpp"
#include "asperity/device/sample.hpp"

namespace asperity {

/// One tick as the gate saw it.
struct flight_entry {
  std::int64_t time_ns = 0;
  device_sample seen{};  ///< newest sample, also where it was rejected
  wrench wanted{};       ///< what came to the gate; may be NaN or infinite, that is the point
  wrench sent{};         ///< what left the gate
};

/// Ring of the last Capacity ticks. freeze() keeps them for whoever asks why.
/// @rt safe
template <std::size_t Capacity>
class basic_flight_recorder {
 public:
  void record(const flight_entry& entry) noexcept {
    if (frozen_) return;
    ring_[next_] = entry;
    next_ = (next_ + 1) % Capacity;
    if (size_ < Capacity) ++size_;
  }
  void freeze() noexcept { frozen_ = true; }
  void clear() noexcept {
    frozen_ = false;
    next_ = 0;
    size_ = 0;
  }

  [[nodiscard]] bool frozen() const noexcept { return frozen_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return Capacity; }
  /// Entry i, the oldest first. @pre i < size()
  [[nodiscard]] const flight_entry& operator[](std::size_t i) const noexcept {
    return ring_[(next_ + Capacity - size_ + i) % Capacity];
  }

 private:
  std::array<flight_entry, Capacity> ring_{};
  std::size_t next_ = 0;
  std::size_t size_ = 0;
  bool frozen_ = false;
};

/// 64 ticks: the last 64 ms at 1 kHz.
using flight_recorder = basic_flight_recorder<64>;

}  // namespace asperity
