// What is known of how often the library is wrong at poses that it did not choose, and whether today's poses are in
// keeping with it: neither worse, nor so much better that the defect is gone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "law/oracle/originals_agree.hpp"

namespace asperity::oracle {

/// Counts of one pair's approaches.
struct tally {
  std::uint64_t approaches = 0;
  std::array<std::array<std::array<std::uint64_t, verdicts>, presses>, 2> of{};  ///< by formulation, press and verdict
  std::array<std::array<std::array<judged_approach, verdicts>, presses>, 2>
      worst;  ///< the approach that passed its bound furthest
  std::uint64_t windows_beyond = 0, windows_empty = 0;
  judged_approach worst_window;
  std::vector<double> window_errors_m;  ///< |depth - originals on the same samples|

  void add(const judged_approach& one);
};

/// Judges approaches first, first + 1, ...
[[nodiscard]] tally judge_approaches(judged_pair& pair, std::uint64_t seed, std::uint64_t first, std::uint64_t count);

/// Prints counts, and for each kind of fault the approach in which it was worst.
void print(const judged_pair& pair, const tally& t);

/// A defect of today's library, as often as it was counted. What is not listed was never seen.
struct known_rate {
  formulation of;
  press by;
  verdict is;
  std::uint64_t seen;
};

/// What is known of a pair, from `approaches` with seeds that no test draws.
struct known_pair {
  const char *probe, *fixed;
  std::uint64_t approaches;
  std::vector<known_rate> rates;
  std::uint64_t windows_beyond, windows_empty;
  double window_p50_m;  ///< median of window_errors_m
};

/// How unlikely a count may be, if the library is as it was, before a test fails: some hundred counts are looked at in
/// a run, so one run in ten thousand fails by chance at most.
inline constexpr double least_probability = 1e-6;

/// Probability of `k` or more, and of `k` or fewer, of `n` that happen with probability `p`.
[[nodiscard]] double binomial_at_least(std::uint64_t k, std::uint64_t n, double p);
[[nodiscard]] double binomial_at_most(std::uint64_t k, std::uint64_t n, double p);
/// Bounds of a probability with which `seen` of `all` happened, each with a confidence of 99.9 % (Clopper, Pearson).
[[nodiscard]] double rate_at_most(std::uint64_t seen, std::uint64_t all);
[[nodiscard]] double rate_at_least(std::uint64_t seen, std::uint64_t all);

/// How often something was counted, and how often it is known to be.
struct counted {
  std::string what;
  std::uint64_t now = 0, of = 0;        ///< at today's poses
  std::uint64_t known = 0, of_all = 0;  ///< when it was measured
};
/// Every count of a pair, in the same order for every pair.
[[nodiscard]] std::vector<counted> counts(const tally& t, const known_pair& known);
/// Of all pairs together: what is rare in each is seen in the sum. @pre as many approaches of each
void add_up(std::vector<counted>& sum, const std::vector<counted>& more);

/// One sentence for each count that what is known does not explain; none where all is as it was.
[[nodiscard]] std::vector<std::string> unexplained(const std::vector<counted>& all);

/// One pose at which the library is known to be wrong.
struct known_defect {
  const char *probe, *fixed;
  std::uint64_t seed, index;
  formulation of;
  press by;
  verdict is;
  double excess_m;  ///< beyond its bound
};

}  // namespace asperity::oracle
