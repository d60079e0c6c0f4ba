// A stopwatch for code that shares its machine with others.
#pragma once

#include <ctime>

namespace asperity::command {

/// What this thread has used of the processor since it began, in seconds. Other programs do not count as slowness.
[[nodiscard]] inline double cpu_seconds() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace asperity::command
