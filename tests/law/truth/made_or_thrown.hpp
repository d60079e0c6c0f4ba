// A value that a test cannot go on without.
#pragma once

#include <stdexcept>
#include <utility>

#include "asperity/core/status.hpp"

namespace asperity::truth {

/// @throws std::runtime_error with the error's message where there is no value
template <class Made>
[[nodiscard]] Made made_or_thrown(result<Made> made) {
  if (!made) throw std::runtime_error(made.error().message);
  return std::move(made).value();
}

}  // namespace asperity::truth
