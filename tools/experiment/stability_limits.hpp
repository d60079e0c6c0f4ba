// The stiffest contact that stays passive: a flat pad on a flat pad, ever stiffer.
#pragma once

#include <string>
#include <vector>

#include "experiment.hpp"
#include "stability_hold.hpp"

namespace asperity::experiment {

/// One way to hand contacts over, and how stiff they may be with it.
struct stiffness_limits {
  contact_line line = contact_line::held;
  bool late = true;
  int rate_hz = 100;
  double quiet_n_per_m = 0.0;  ///< stiffest at which the hand rests after every touch; 0: none of those that were tried
  double bounded_n_per_m = 0.0;  ///< ... at which it gets no more than the guard would let through, without the guard
  double guarded_n_per_m = 0.0;  ///< the same with the guard
};

/// What the sessions with the guard came to, all together.
struct guard_record {
  double worst_share = 0.0;       ///< largest surplus over its bound
  double worst_bare_share = 0.0;  ///< the same of the sessions without the guard that they repeat
  int sessions = 0, acted = 0;
};

/// Contact stiffnesses that are tried: every power of two between them, in brief every eighth.
inline constexpr double softest_n_per_m = 125.0, stiffest_n_per_m = 64e3;

[[nodiscard]] constexpr std::int64_t period_of(int rate_hz) noexcept { return 1'000'000'000 / rate_hz; }

/// All lines, both latencies, at these rates. @return the error of a trial
[[nodiscard]] result<std::vector<stiffness_limits>> find_stiffness_limits(workbench& bench,
                                                                          const std::vector<int>& rates_hz,
                                                                          guard_record& record);

[[nodiscard]] const char* line_text(contact_line line) noexcept;
[[nodiscard]] shown_table limits_table(const std::vector<stiffness_limits>& all);
[[nodiscard]] table limits_csv(const std::vector<stiffness_limits>& all);

}  // namespace asperity::experiment
