// Whether a count out of a few poses of the day is in keeping with a share that was promised of all poses.
#pragma once

#include <cmath>
#include <cstddef>

namespace asperity::truth {

/// Probability of `k` or more of `n` that happen with probability `p` each.
[[nodiscard]] inline double at_least(std::size_t k, std::size_t n, double p) {
  double sum = 0.0;
  for (std::size_t i = k; i <= n; ++i) {
    const auto a = static_cast<double>(n), b = static_cast<double>(i);
    sum += std::exp(std::lgamma(a + 1.0) - std::lgamma(b + 1.0) - std::lgamma(a - b + 1.0) + b * std::log(p) +
                    (a - b) * std::log1p(-p));
  }
  return sum;
}

/// Whether so many beyond a bound are more than a share of `p` lets happen in one run of a million: a strict bound at
/// poses of the day would be red on most days.
[[nodiscard]] inline bool more_than(double p, std::size_t beyond, std::size_t of) {
  constexpr double least_probability = 1e-6;
  return beyond > 0 && at_least(beyond, of, p) < least_probability;
}

}  // namespace asperity::truth
