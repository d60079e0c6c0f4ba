// Numbers and arrays of a packed field, in and out of bytes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"

namespace asperity::detail {

static_assert(std::endian::native == std::endian::little, "a packed field is little-endian, and copied as it lies");

/// Appends to bytes.
class field_writer {
 public:
  template <class T>
  void number(T x) {
    static_assert(std::is_arithmetic_v<T>);
    array(std::span<const T>(&x, 1));
  }
  void vector(const vec3& v) {
    for (int k = 0; k < 3; ++k) number(v[k]);
  }
  template <class T>
  void array(std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto bytes = std::as_bytes(items);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// An array whose items are mostly `usual`: a bit for each that is not, then these.
  template <class T>
  void sparse(std::span<const T> items, const T& usual) {
    for (std::size_t first = 0; first < items.size(); first += 64) {
      std::uint64_t unusual = 0;
      for (std::size_t i = first; i < std::min(first + 64, items.size()); ++i) {
        if (std::memcmp(&items[i], &usual, sizeof usual) != 0) unusual |= std::uint64_t{1} << (i - first);
      }
      number(unusual);
    }
    for (const T& item : items) {
      if (std::memcmp(&item, &usual, sizeof usual) != 0) array(std::span<const T>(&item, 1));
    }
  }

  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads until something is wrong; from then on everything is zero or empty, and wrong() says what it was.
class field_reader {
 public:
  explicit field_reader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  /// What was wrong first; empty while all is well.
  [[nodiscard]] const std::string& wrong() const noexcept { return wrong_; }
  void reject(std::string what) {
    if (wrong_.empty()) wrong_ = std::move(what);
    bytes_ = {};
  }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size(); }

  template <class T>
  [[nodiscard]] T number(const char* name) {
    static_assert(std::is_arithmetic_v<T>);
    T out{};
    if (has(sizeof(T), name)) copy(&out, sizeof(T));
    return out;
  }
  /// A number from low to high; NaN is none.
  [[nodiscard]] double number_between(double low, double high, const char* name) {
    const double x = number<double>(name);
    if (wrong_.empty() && !(x >= low && x <= high)) {
      reject(std::string(name) + " is " + std::to_string(x) + ", not " + std::to_string(low) + " to " +
             std::to_string(high));
    }
    return wrong_.empty() ? x : low;
  }
  [[nodiscard]] vec3 vector(double most, const char* name) {
    vec3 out{0.0};
    for (int k = 0; k < 3; ++k) out[k] = number_between(-most, most, name);
    return out;
  }
  /// Nothing is allocated before the bytes are known to be there.
  template <class T>
  [[nodiscard]] std::vector<T> array(std::size_t count, const char* name) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> out;
    if (count > bytes_.size() / sizeof(T)) {
      end_early(name);
      return out;
    }
    out.resize(count);
    copy(out.data(), count * sizeof(T));
    return out;
  }
  /// What field_writer::sparse() wrote of as many items, over those that are not usual.
  template <class T>
  void sparse(std::span<T> over_usual, const char* name) {
    const auto unusual = array<std::uint64_t>((over_usual.size() + 63) / 64, name);
    std::size_t given = 0;
    for (const std::uint64_t word : unusual) given += static_cast<std::size_t>(std::popcount(word));
    const std::size_t in_last = over_usual.size() % 64;
    if (in_last != 0 && !unusual.empty() && unusual.back() >> in_last != 0) {
      reject(std::string(name) + " has more items than there are");
    } else if (given > bytes_.size() / sizeof(T)) {
      end_early(name);
    }
    if (!wrong_.empty()) return;
    for (std::size_t w = 0; w < unusual.size(); ++w) {
      for (std::uint64_t bits = unusual[w]; bits != 0; bits &= bits - 1) {
        copy(&over_usual[64 * w + static_cast<std::size_t>(std::countr_zero(bits))], sizeof(T));
      }
    }
  }
  /// Whether the bytes that are left may hold so many items, of which all are usual. To be asked before memory is taken
  /// for them.
  [[nodiscard]] bool may_hold_sparse(std::uint64_t count, const char* name) {
    if (!wrong_.empty()) return false;
    if (count / 8 <= bytes_.size()) return true;
    end_early(name);
    return false;
  }

 private:
  void end_early(const char* name) { reject(std::string("its bytes end in ") + name); }
  [[nodiscard]] bool has(std::size_t bytes, const char* name) {
    if (bytes_.size() >= bytes) return true;
    end_early(name);
    return false;
  }
  void copy(void* to, std::size_t bytes) noexcept {
    if (bytes == 0) return;
    std::memcpy(to, bytes_.data(), bytes);
    bytes_ = bytes_.subspan(bytes);
  }

  std::span<const std::byte> bytes_;
  std::string wrong_;
};

/// Whether every number of an array is finite.
[[nodiscard]] inline bool all_finite(std::span<const float> numbers) noexcept {
  // A sum of zeros is zero, and NaN where one of them is not finite.
  float sum = 0.0F;
  for (const float x : numbers) sum += 0.0F * x;
  return sum == 0.0F;
}

}  // namespace asperity::detail
