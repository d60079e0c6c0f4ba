// Many rows at a time, on several threads.
#pragma once

#include <cstddef>
#include <functional>

#include "asperity/core/status.hpp"

namespace asperity::python {

struct batch_outcome {
  std::size_t incomplete = 0;  ///< rows at which a capacity was reached
  status failed = status::ok;  ///< of the first row that could not be computed
  std::size_t failed_at = 0;   ///< that row
};

/// How rows are shared out: in blocks, to whichever thread is free.
struct batch_shares {
  std::size_t rows = 0;
  std::size_t threads = 1;  ///< at most; the calling one works too
  std::size_t block = 32;   ///< half a millisecond to some: short beside a signal, long beside a counter
};

/// Steps every row once.
/// @param step (thread, row): thread from 0, below shares.threads; rows of one thread come one after the other. Where a row
///        depends on nothing but itself, the threads' number changes nothing.
/// @param keep_going asked on the calling thread between blocks
[[nodiscard]] batch_outcome step_rows(const batch_shares& shares,
                                      const std::function<status(std::size_t, std::size_t)>& step,
                                      const std::function<bool()>& keep_going);

}  // namespace asperity::python
