#include <cstdio>
#include <gtest/gtest.h>
#include <string>

#include "session/simulation/every_session.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity::simulation;

TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  // With the seeds of simulation_test, 2000.
  static_cast<void>(check_every_session({201, 1800}));
}

// Each day others. A session that breaks is repeated by its own seed.
void run_sessions_of_today(std::uint64_t count) {
  const std::uint64_t day = asperity::test_support::fresh_seed("simulation", std::to_string(count) + " sessions");
  const summary all = run_sessions({1'000'000 * day, count});
  std::printf("%s\n", to_string(all).c_str());
  EXPECT_EQ(all.sessions, count);
  EXPECT_GT(all.faults, count / 2);  // sessions that meet nothing prove nothing
  for (const outcome& o : all.broken) {
    ADD_FAILURE() << to_string(o) << "\nrepeat with: ASPERITY_SESSION=" << o.seed
                  << " simulation_test --gtest_filter=simulation.every_invariant*";
  }
}

TEST(simulation, every_invariant_holds_in_the_sessions_of_today) {
  run_sessions_of_today(asperity::test_support::extent(30U, 500U));
}

TEST(simulation, DISABLED_every_invariant_holds_in_many_sessions_of_today) { run_sessions_of_today(20'000); }

}  // namespace
