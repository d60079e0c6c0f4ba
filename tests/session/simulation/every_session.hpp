// The one question of all seeds, with an answer that can be repeated.
#pragma once

#include <cstdio>
#include <gtest/gtest.h>

#include "session/simulation/many_sessions.hpp"

namespace asperity::simulation {

/// Runs the seeds, or the one in ASPERITY_SESSION, prints their figures and fails for each session in which something
/// broke: with seed, tick, invariant and the command that repeats it.
inline summary check_every_session(const seed_range& seeds) {
  const summary all = run_sessions(seeds_to_run(seeds));
  std::printf("%s\n", to_string(all).c_str());
  for (const outcome& o : all.broken) {
    ADD_FAILURE() << to_string(o) << "\nrepeat with: ASPERITY_SESSION=" << o.seed << " "
                  << testing::internal::GetArgvs().front() << " --gtest_filter=simulation.every_invariant*";
  }
  return all;
}

}  // namespace asperity::simulation
