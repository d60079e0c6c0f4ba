// Hand-overs with one thing wrong each, and what they hand over.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace asperity::test_support {

/// A payload wide enough that a torn read shows: all words carry the same number.
/// @tparam Word  std::uint64_t; or an atomic, where a variant is meant to tear without a data race
template <class Word>
struct wide_payload {
  std::array<Word, 56> words{};
};

/// A word that several threads may touch at once: reading it is never a data race, and orders nothing.
class relaxed_word {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): it stands for the number that it holds
  operator std::uint64_t() const noexcept { return value_.load(std::memory_order_relaxed); }
  void operator=(std::uint64_t v) noexcept { value_.store(v, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

/// Atomic, but the order that is asked for is forgotten: the exchange publishes nothing but itself.
template <class T>
class relaxed_atomic {
 public:
  relaxed_atomic(T v) noexcept : value_(v) {}
  [[nodiscard]] T load(std::memory_order) const noexcept { return value_.load(std::memory_order_relaxed); }
  [[nodiscard]] T exchange(T v, std::memory_order) noexcept { return value_.exchange(v, std::memory_order_relaxed); }

 private:
  std::atomic<T> value_;
};

/// A hand-over with two slots: the producer begins to write where the consumer still reads.
template <class T, template <class> class Atomic = std::atomic>
class two_slot_buffer {
 public:
  [[nodiscard]] T& back() noexcept { return slots_[write_]; }
  void publish() noexcept {
    static_cast<void>(newest_.exchange(static_cast<std::uint8_t>(write_ | fresh), std::memory_order_acq_rel));
    write_ ^= 1U;
  }
  bool refresh() noexcept {
    const std::uint8_t newest = newest_.load(std::memory_order_relaxed);
    if ((newest & fresh) == 0) return false;
    read_ = newest_.exchange(newest & 1U, std::memory_order_acq_rel) & 1U;
    return true;
  }
  [[nodiscard]] const T& front() const noexcept { return slots_[read_]; }

 private:
  static constexpr std::uint8_t fresh = 4;

  std::array<T, 2> slots_{};
  Atomic<std::uint8_t> newest_{0};
  std::uint8_t write_ = 1;
  std::uint8_t read_ = 0;
};

}  // namespace asperity::test_support
