// Textures that are scrubbed while contacts are slow: planes that are read again are where the surface is.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>

#include "law/presses/press_law.hpp"
#include "law/presses/scrub_session.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::presses {
namespace {

// How far planes that are read again are off the surface, as a share of what those are that stay as they were told. No
// less than a fifth of a micrometre is told apart.
double share(const plane_error& again, const plane_error& stay) {
  constexpr double least_m = 2e-7;
  return std::max(least_m, again.rms_m) / std::max(least_m, stay.rms_m);
}

// In the geometric mean of 30 hands they are off by less. Of one hand nobody promises it, so one is only looked at: where
// a probe slides off an edge, points come to press that the contact has no plane of, and the planes that it has follow
// the surface down.
TEST(scrubs, are_felt_between_contacts) {
  const std::uint64_t seed = test_support::fresh_seed("scrubs", "a hand on one pair, at length on 30");
  const bool at_length = test_support::at_length();
  press_shelf shelf(press_bake::simplified);
  print_scrub_heading(stdout);
  double log_shares = 0.0;
  int rows = 0, pressed = 0;
  for (const press_pair& pair : benchmark_pairs()) {
    if (!at_length && pair.name() != "torus on block") continue;
    const auto probe = shelf.get(pair.probe), fixed = shelf.get(pair.fixed);
    ASSERT_TRUE(probe && fixed);
    const auto row = scrub_sessions(pair, **probe, **fixed, {seed, 1, 0, 1e-4});
    ASSERT_TRUE(row) << row.error().message;
    print_row(stdout, pair, *row);
    ++rows;
    for (std::size_t r = 0; r < scrub_rates_hz.size(); ++r) {
      log_shares += std::log(share(row->read_again[r], row->stay[r]));
      pressed += row->stay[r].ticks > 100 && row->read_again[r].ticks > 100 ? 1 : 0;
    }
  }
  const double mean = std::exp(log_shares / (static_cast<double>(scrub_rates_hz.size()) * rows));
  std::printf("  off by %.2f of what planes are that stay\n", mean);
  EXPECT_LT(mean, at_length ? 0.8 : 3.0);
  EXPECT_GT(pressed, 2 * rows);
}

}  // namespace
}  // namespace asperity::presses
