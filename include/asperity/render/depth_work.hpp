// What a tick of samples and depth fields took.
#pragma once

#include <concepts>
#include <cstdint>

namespace asperity {

/// How many samples a tick found near, and what it took to tell which of them count. Zero where nobody counts.
struct depth_work {
  std::uint32_t looked_at = 0;  ///< balls of samples, large and small, that a finder could not leave unread
  std::uint32_t listed = 0;     ///< samples that may be within reach
  std::uint32_t bounded = 0;    ///< leaves, a few samples each, that a reading bounded
  std::uint32_t quick = 0;      ///< samples that were read in single precision, to tell whether they need more
  std::uint32_t exact = 0;      ///< samples that were read in double precision with all derivatives
};

/// A stage of a renderer that counts what its last tick took.
template <class P>
concept reports_work = requires(const P& stage) {
  { stage.work() }
  noexcept->std::same_as<const depth_work&>;
};

}  // namespace asperity
