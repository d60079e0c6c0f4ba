// How far a test goes. The ordinary run takes a share of what is long and shows the same thing more often; nightly entries
// take all of it.
#pragma once

#include <cstdlib>
#include <string_view>

namespace asperity::test_support {

/// Whether this run is at length: ASPERITY_AT_LENGTH is set, and not to 0.
[[nodiscard]] inline bool at_length() {
  const char* const asked = std::getenv("ASPERITY_AT_LENGTH");
  return asked != nullptr && *asked != '\0' && std::string_view(asked) != "0";
}

/// `all` in a run at length, otherwise `share`.
template <class T>
[[nodiscard]] T extent(T share, T all) {
  return at_length() ? all : share;
}

}  // namespace asperity::test_support
