// Counts what a piece of code takes from the heap.
#pragma once

#include <cstddef>

namespace asperity::test_support {

/// Allocations and releases of this thread through operator new and delete since the guard was made.
/// Link allocation_guard.cpp, which replaces the global operators.
class allocation_guard {
 public:
  allocation_guard() noexcept;
  [[nodiscard]] std::size_t allocations() const noexcept;
  [[nodiscard]] std::size_t releases() const noexcept;

 private:
  std::size_t allocations_before_;
  std::size_t releases_before_;
};

}  // namespace asperity::test_support
