#include <array>
#include <cstdint>
#include <gtest/gtest.h>

#include "simulation/every_session.hpp"

namespace {

using namespace asperity::simulation;

// The first of the sessions that simulation_long_test goes on with, few enough for builds without optimisation and
// under sanitizers.
TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  const summary all = check_every_session({1, 200});
  if (all.sessions < 200) return;
  // Sessions that meet nothing prove nothing.
  EXPECT_GT(all.textured, 10U);
  EXPECT_GT(all.touched, all.ticks / 5);
  EXPECT_GT(all.guarded, all.ticks / 100);
  EXPECT_GT(all.rejected, all.ticks / 100);
  EXPECT_GT(all.faults, 100U);
  EXPECT_GT(all.clears, 100U);
  EXPECT_GT(all.past_hard_limit, 0U);
}

TEST(simulation, is_the_same_to_the_bit_for_the_same_seed) {
  std::array<std::uint64_t, 40> digests{};
  for (std::uint64_t i = 0; i < digests.size(); ++i) digests[i] = run_sessions({1 + i, 1}).digest;
  for (std::uint64_t i = 0; i < digests.size(); ++i) {
    ASSERT_EQ(run_sessions({1 + i, 1}).digest, digests[i]) << "seed " << 1 + i;
    ASSERT_NE(digests[i], digests[(i + 1) % digests.size()]) << "seed " << 1 + i;
  }
}

}  // namespace
