// Hand-over of the newest value from one thread to another without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace asperity {

/// Single producer, single consumer, wait-free; the newest published value wins and older ones are skipped.
/// Three slots: one being written, one being read, one in the middle that the two sides swap with theirs.
/// The swap is acquire-release on both sides: what the producer wrote before publish() is seen after refresh().
/// @tparam Atomic  std::atomic; tests replace it by a type that chooses the order of the accesses
/// @rt safe on both sides
template <class T, template <class> class Atomic = std::atomic>
class triple_buffer {
 public:
  /// Slot to fill before publish(). Producer only. Holds an old value: write every field.
  [[nodiscard]] T& back() noexcept { return slots_[write_]; }

  /// Makes back() the newest value. Producer only.
  void publish() noexcept { write_ = middle_.exchange(write_ | fresh, std::memory_order_acq_rel) & index_mask; }

  /// Takes the newest value where there is one that was not taken yet. Consumer only. @return whether front() changed
  bool refresh() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    read_ = middle_.exchange(read_, std::memory_order_acq_rel) & index_mask;
    return true;
  }

  /// The value that the last refresh() took (a default T before the first). Consumer only.
  [[nodiscard]] const T& front() const noexcept { return slots_[read_]; }

 private:
  static constexpr std::uint8_t index_mask = 3;
  static constexpr std::uint8_t fresh = 4;

  std::array<T, 3> slots_{};
  // Each side's own index on its own cache line, so that polling does not slow the other side down.
  alignas(64) Atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t write_ = 0;
  alignas(64) std::uint8_t read_ = 2;
};

}  // namespace asperity
