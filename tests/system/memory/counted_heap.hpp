// A global heap that knows how many bytes are on loan.
#pragma once

#include <cstddef>

namespace asperity::test_support {

/// Bytes that were asked for with `new` and not given back yet, in the whole program.
[[nodiscard]] std::size_t bytes_on_loan() noexcept;

/// The most that bytes_on_loan() has been since the last watch_from_here().
[[nodiscard]] std::size_t most_bytes_on_loan() noexcept;
void watch_from_here() noexcept;

}  // namespace asperity::test_support
