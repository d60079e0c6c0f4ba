// Counts allocations of C++ code in this thread.
#pragma once

#include <cstddef>

namespace asperity::test_support {

/// Calls of operator new in this thread so far. What C libraries and drivers take with malloc() is not counted.
[[nodiscard]] std::size_t news_in_this_thread() noexcept;

}  // namespace asperity::test_support
