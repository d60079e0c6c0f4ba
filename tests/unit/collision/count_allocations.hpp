// Counts calls of operator new in this executable.
#pragma once

#include <cstddef>

namespace asperity::test {

/// Calls of operator new since the start.
[[nodiscard]] std::size_t allocation_count() noexcept;

}  // namespace asperity::test
