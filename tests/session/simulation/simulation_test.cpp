#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "session/simulation/every_session.hpp"
#include "support/extent.hpp"

namespace {

using namespace asperity::simulation;

// The first of the sessions that simulation_long_test goes on with at length, few enough for builds without optimisation
// and under sanitizers.
TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  const std::uint64_t sessions = asperity::test_support::extent(40U, 200U);
  const summary all = check_every_session({1, sessions});
  if (all.sessions < sessions) return;
  // Sessions that meet nothing prove nothing.
  EXPECT_GT(all.textured, sessions / 20);
  EXPECT_GT(all.touched, all.ticks / 5);
  EXPECT_GT(all.guarded, all.ticks / 100);
  EXPECT_GT(all.rejected, all.ticks / 100);
  EXPECT_GT(all.faults, sessions / 2);
  EXPECT_GT(all.clears, sessions / 2);
  EXPECT_GT(all.past_hard_limit, 0U);
}

TEST(simulation, is_the_same_to_the_bit_for_the_same_seed) {
  std::vector<std::uint64_t> digests(asperity::test_support::extent<std::size_t>(10, 40));
  for (std::uint64_t i = 0; i < digests.size(); ++i) digests[i] = run_sessions({1 + i, 1}).digest;
  for (std::uint64_t i = 0; i < digests.size(); ++i) {
    ASSERT_EQ(run_sessions({1 + i, 1}).digest, digests[i]) << "seed " << 1 + i;
    ASSERT_NE(digests[i], digests[(i + 1) % digests.size()]) << "seed " << 1 + i;
  }
}

}  // namespace
