// What a set of measured times amounts to.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "text.hpp"

namespace asperity::command {

/// Order statistics of durations in seconds; zeros where nothing was measured.
struct time_summary {
  std::size_t count = 0;
  double mean_s = 0.0, p50_s = 0.0, p99_s = 0.0, max_s = 0.0;
};

/// Percentiles are values that occurred (nearest rank), never interpolations between a common and a rare one.
[[nodiscard]] inline time_summary summarise(std::vector<double> seconds) {
  time_summary s;
  s.count = seconds.size();
  if (seconds.empty()) return s;
  std::sort(seconds.begin(), seconds.end());
  const auto rank = [&](double share) {
    const double n = std::ceil(share * static_cast<double>(seconds.size()));
    return seconds[static_cast<std::size_t>(std::max(1.0, n)) - 1];
  };
  for (const double t : seconds) s.mean_s += t / static_cast<double>(seconds.size());
  s.p50_s = rank(0.50);
  s.p99_s = rank(0.99);
  s.max_s = seconds.back();
  return s;
}

[[nodiscard]] nlohmann::ordered_json to_json(const time_summary& s);

[[nodiscard]] inline std::string to_text(const time_summary& s) {
  return "p50 " + time_text(s.p50_s) + ", p99 " + time_text(s.p99_s) + ", max " + time_text(s.max_s);
}

}  // namespace asperity::command
