#include <cstdio>
#include <gtest/gtest.h>

#include "simulation/every_session.hpp"
#include "support/extent.hpp"

namespace {

using namespace asperity::simulation;

TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  // With the seeds of simulation_test, 2000 at length and 500 otherwise.
  static_cast<void>(check_every_session({201, asperity::test_support::extent(300U, 1800U)}));
}

// Ten times as many, and each day others. A session that breaks is repeated by its own seed.
TEST(simulation, DISABLED_every_invariant_holds_in_the_sessions_of_today) {
  const std::uint64_t day = asperity::test_support::seed_of_the_day();
  std::printf("sessions from seed %llu on (ASPERITY_SEED=%llu repeats them)\n",
              static_cast<unsigned long long>(1'000'000 * day), static_cast<unsigned long long>(day));
  const summary all = run_sessions({1'000'000 * day, 20'000});
  std::printf("%s\n", to_string(all).c_str());
  EXPECT_EQ(all.sessions, 20'000U);
  EXPECT_GT(all.faults, 10'000U);  // sessions that meet nothing prove nothing
  for (const outcome& o : all.broken) {
    ADD_FAILURE() << to_string(o) << "\nrepeat with: ASPERITY_SEED=" << o.seed
                  << " simulation_test --gtest_filter=simulation.every_invariant*";
  }
}

}  // namespace
