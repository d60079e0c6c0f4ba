// Runs the examination in a process of its own, so that a driver that crashes or hangs is a result and not the end.
#pragma once

#include <functional>
#include <string>

#include "progress.hpp"

namespace asperity::conformance {

/// How the process ended.
struct process_end {
  int exit_status = 1;  ///< where `broken` is empty
  std::string broken;   ///< what ended it, and in which call, where it did not come to its end
};

/// Runs `work` in a forked process and returns its answer, which becomes the exit status (0 or 1). A call into the
/// driver that does not return within `patience_s` seconds is ended.
[[nodiscard]] process_end in_own_process(const std::function<int(progress&)>& work, int patience_s = 60);

}  // namespace asperity::conformance
