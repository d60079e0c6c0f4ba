// Many seeds in a row, and what came of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "session/simulation/outcome.hpp"

namespace asperity::simulation {

/// Seeds [first, first + count).
struct seed_range {
  std::uint64_t first = 1;
  std::uint64_t count = 0;
};

/// The seed in ASPERITY_SESSION, which is one session, as a range of one; otherwise `otherwise`. ASPERITY_SEED is
/// another thing: where a day's sessions are drawn from.
[[nodiscard]] seed_range seeds_to_run(seed_range otherwise);

struct summary {
  std::uint64_t sessions = 0;
  std::uint64_t textured = 0;
  std::uint64_t ticks = 0;
  std::uint64_t touched = 0;
  std::uint64_t guarded = 0;
  std::uint64_t rejected = 0;
  std::uint64_t faults = 0;
  std::uint64_t clears = 0;
  std::uint64_t past_hard_limit = 0;  ///< sessions in which the guard's hard limit was passed
  double surplus_j = 0.0;             ///< largest of all sessions
  std::uint64_t digest = 0;           ///< of all sessions; their order matters
  std::vector<outcome> broken;
};

/// Runs every seed to its end, or to the first invariant that breaks in it.
[[nodiscard]] summary run_sessions(const seed_range& seeds);

/// One line for a session in which something broke: seed, tick, invariant.
[[nodiscard]] std::string to_string(const outcome& o);
/// Figures in one line.
[[nodiscard]] std::string to_string(const summary& s);

}  // namespace asperity::simulation
