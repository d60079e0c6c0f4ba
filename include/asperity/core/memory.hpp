// How much memory an object holds. Counted from capacities, so that it can be asked at any time and costs nothing.
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace asperity {

/// A type that says what it holds on the heap: bytes, beyond its own sizeof.
template <class T>
concept reports_heap = requires(const T& object) {
  { object.heap_bytes() }
  noexcept->std::same_as<std::size_t>;
};

/// Bytes on the heap that belong to an object, beyond its own sizeof: capacities, used or not.
///
/// What the allocator adds to each block (8 to 16 bytes with glibc) is not counted. What a shared pointer refers to
/// belongs to nobody in particular and counts as nothing here. A type that holds memory and does not say how much does
/// not compile, so that a new member cannot be forgotten by accident.
template <class T>
requires(reports_heap<T> || std::is_trivially_copyable_v<T>) [[nodiscard]] constexpr std::size_t
    heap_bytes(const T& object) noexcept {
  if constexpr (reports_heap<T>) {
    return object.heap_bytes();
  } else {
    return 0;
  }
}

template <class T>
[[nodiscard]] std::size_t heap_bytes(const std::shared_ptr<T>&) noexcept {
  return 0;
}

[[nodiscard]] inline std::size_t heap_bytes(const std::string& text) noexcept {
  // A short string lies inside the object.
  const auto* const self = reinterpret_cast<const char*>(&text);
  const bool inside = text.data() >= self && text.data() < self + sizeof(std::string);
  return inside ? 0 : text.capacity() + 1;
}

template <class T>
[[nodiscard]] std::size_t heap_bytes(const std::vector<T>& list) noexcept {
  std::size_t bytes = list.capacity() * sizeof(T);
  if constexpr (!std::is_trivially_copyable_v<T>) {
    for (const T& item : list) bytes += heap_bytes(item);
  }
  return bytes;
}

/// The sum over several objects: what a type with these members holds on the heap.
template <class First, class Second, class... Rest>
[[nodiscard]] std::size_t heap_bytes(const First& first, const Second& second, const Rest&... rest) noexcept {
  if constexpr (sizeof...(Rest) == 0) {
    return heap_bytes(first) + heap_bytes(second);
  } else {
    return heap_bytes(first) + heap_bytes(second, rest...);
  }
}

}  // namespace asperity

namespace asperity::detail {

/// As v.reserve(count) for a vector that is still empty, and touches what it took. The kernel finds a page for reserved
/// memory at the first access, which would be in the first tick that needs that much.
template <class T>
void reserve_resident(std::vector<T>& v, std::size_t count) {
  v.resize(count);
  v.clear();
}

}  // namespace asperity::detail
