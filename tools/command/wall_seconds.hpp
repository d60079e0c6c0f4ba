// How long a call takes on the wall, for work that another processor does.
#pragma once

#include <chrono>

namespace asperity::command {

/// Seconds that call() took.
template <class Call>
[[nodiscard]] double wall_seconds(Call&& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace asperity::command
