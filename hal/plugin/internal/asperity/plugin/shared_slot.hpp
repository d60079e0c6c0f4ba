// A value that one process writes and another reads, without either ever waiting for the other.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace asperity::plugin {

/// The newest value only. The reader is told where a value was changed while it copied it, and never gets half of one
/// from a writer that keeps the rules; what comes from another process is judged afterwards all the same.
/// One writer, one reader. No pointer and no lock in it, so that it can lie in memory that processes share.
template <class T>
class shared_slot {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  static constexpr std::size_t word_count = (sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);

 public:
  /// @rt safe
  void put(const T& value) noexcept {
    std::array<std::uint64_t, word_count> copy{};
    std::memcpy(copy.data(), &value, sizeof value);
    const std::uint64_t before = sequence_.load(std::memory_order_relaxed) & ~std::uint64_t{1};
    sequence_.store(before + 1, std::memory_order_relaxed);
    // Released one by one, so that none is seen before the odd number above.
    for (std::size_t i = 0; i < word_count; ++i) words_[i].store(copy[i], std::memory_order_release);
    sequence_.store(before + 2, std::memory_order_release);
  }

  /// Bounded work. @return false where nothing was put yet, or it changed in each of a few attempts
  /// @rt safe
  [[nodiscard]] bool get(T& out) const noexcept {
    constexpr int attempts = 8;
    std::array<std::uint64_t, word_count> copy{};
    for (int n = 0; n < attempts; ++n) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before == 0 || (before & 1U) != 0) continue;
      for (std::size_t i = 0; i < word_count; ++i) copy[i] = words_[i].load(std::memory_order_acquire);
      if (sequence_.load(std::memory_order_relaxed) != before) continue;
      std::memcpy(static_cast<void*>(&out), copy.data(), sizeof out);
      return true;
    }
    return false;
  }

 private:
  std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, word_count> words_{};
};

}  // namespace asperity::plugin
