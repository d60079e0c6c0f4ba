// How far a test goes. The ordinary run takes a share of what is long and shows the same thing more often; the entries
// labelled at_length, which ./dev check runs, take all of it.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <ctime>
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

/// The seed of today's DISABLED_ cases: ASPERITY_SEED, or the date in UTC as yyyymmdd.
[[nodiscard]] inline std::uint64_t seed_of_the_day() {
  if (const char* const given = std::getenv("ASPERITY_SEED"); given != nullptr && *given != '\0') {
    return std::strtoull(given, nullptr, 10);
  }
  const std::time_t now = std::time(nullptr);
  std::tm day{};
  gmtime_r(&now, &day);
  return static_cast<std::uint64_t>((day.tm_year + 1900) * 10000 + (day.tm_mon + 1) * 100 + day.tm_mday);
}

}  // namespace asperity::test_support
