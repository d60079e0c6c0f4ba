// A vector whose capacity is part of its type. It counts the elements that did not fit.
#pragma once

#include <array>
#include <cstddef>

namespace asperity {

/// Contiguous sequence of at most Capacity elements, stored inside the object. Never allocates.
/// push_back beyond the capacity drops the element, returns false and counts it in dropped().
/// @rt safe
template <class T, std::size_t Capacity>
class fixed_vector {
 public:
  using value_type = T;
  using iterator = T*;
  using const_iterator = const T*;

  [[nodiscard]] bool push_back(const T& v) noexcept {
    if (size_ == Capacity) {
      ++dropped_;
      return false;
    }
    data_[size_++] = v;
    return true;
  }
  void clear() noexcept {
    size_ = 0;
    dropped_ = 0;
  }
  /// Shortens to n elements. @pre n <= size()
  void truncate(std::size_t n) noexcept { size_ = n; }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] bool full() const noexcept { return size_ == Capacity; }
  /// Elements refused since the last clear().
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return Capacity; }

  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  [[nodiscard]] T& back() noexcept { return data_[size_ - 1]; }
  [[nodiscard]] T* data() noexcept { return data_.data(); }
  [[nodiscard]] const T* data() const noexcept { return data_.data(); }
  [[nodiscard]] iterator begin() noexcept { return data(); }
  [[nodiscard]] iterator end() noexcept { return data() + size_; }
  [[nodiscard]] const_iterator begin() const noexcept { return data(); }
  [[nodiscard]] const_iterator end() const noexcept { return data() + size_; }

 private:
  std::array<T, Capacity> data_{};
  std::size_t size_ = 0;
  std::size_t dropped_ = 0;
};

}  // namespace asperity
