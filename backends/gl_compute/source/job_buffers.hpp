// The memory that jobs are written to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "job_layout.hpp"

namespace asperity::gl {

/// Numbers of double or single precision, one after the other. Writing past the end is counted, not done.
class number_list {
 public:
  number_list() = default;
  explicit number_list(std::span<double> wide) noexcept : wide_(wide), size_(wide.size()) {}
  explicit number_list(std::span<float> narrow) noexcept : narrow_(narrow), size_(narrow.size()) {}

  void add(double x) noexcept {
    if (used_ < size_) {
      if (narrow_.empty()) {
        wide_[used_] = x;
      } else {
        narrow_[used_] = static_cast<float>(x);
      }
    }
    ++used_;
  }
  template <class Vector>
  void add_vector(const Vector& v) noexcept {
    for (int i = 0; i < v.length(); ++i) add(v[i]);
  }
  /// A number as it will arrive.
  [[nodiscard]] double rounded(double x) const noexcept {
    return narrow_.empty() ? x : static_cast<double>(static_cast<float>(x));
  }
  [[nodiscard]] double operator[](std::size_t i) const noexcept {
    return narrow_.empty() ? wide_[i] : static_cast<double>(narrow_[i]);
  }
  [[nodiscard]] std::size_t used() const noexcept { return used_; }
  [[nodiscard]] bool overflowed() const noexcept { return used_ > size_; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return used_ * (narrow_.empty() ? sizeof(double) : sizeof(float));
  }

 private:
  std::span<double> wide_;
  std::span<float> narrow_;
  std::size_t size_ = 0, used_ = 0;
};

/// Integers: first those of the jobs, then whatever the jobs refer to.
class integer_list {
 public:
  integer_list() = default;
  integer_list(std::span<std::int32_t> all, std::size_t jobs) noexcept
      : all_(all), used_(jobs * static_cast<std::size_t>(job::integers)) {}

  void set(std::size_t job, int what, std::size_t value) noexcept {
    all_[job * static_cast<std::size_t>(job::integers) + static_cast<std::size_t>(what)] =
        static_cast<std::int32_t>(value);
  }
  void copy_job(std::size_t from, std::size_t to) noexcept {
    for (int i = 0; i < job::integers; ++i) {
      const auto at = static_cast<std::size_t>(i), n = static_cast<std::size_t>(job::integers);
      all_[to * n + at] = all_[from * n + at];
    }
  }
  void add(std::int32_t x) noexcept {
    if (used_ < all_.size()) all_[used_] = x;
    ++used_;
  }
  [[nodiscard]] std::size_t used() const noexcept { return used_; }
  [[nodiscard]] bool overflowed() const noexcept { return used_ > all_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return used_ * sizeof(std::int32_t); }

 private:
  std::span<std::int32_t> all_;
  std::size_t used_ = 0;
};

}  // namespace asperity::gl
