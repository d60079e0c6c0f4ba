// Textures that are scrubbed while contacts are slow: planes that are read again are where the surface is.
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "law/presses/press_law.hpp"
#include "law/presses/scrub_session.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::presses {
namespace {

// Of all hands together, planes that are read again are off by less than the planes that stay as they were told.
TEST(scrubs, are_felt_between_contacts) {
  const std::uint64_t seed =
      test_support::fresh_seed("scrubs", "a hand on 1 of 3 pairs of benchmark models, 3 on each at length");
  const std::vector<std::string> names{"hammer on torus", "cad_part on gear", "file on block"};
  press_shelf shelf(press_bake::simplified);
  print_scrub_heading(stdout);
  double stay[scrub_rates_hz.size()] = {}, again[scrub_rates_hz.size()] = {};
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (!test_support::at_length() && n != seed % names.size()) continue;
    for (const press_pair& pair : benchmark_pairs()) {
      if (pair.name() != names[n]) continue;
      const auto probe = shelf.get(pair.probe), fixed = shelf.get(pair.fixed);
      ASSERT_TRUE(probe && fixed);
      for (int i = 0; i < test_support::extent(1, 3); ++i) {
        const auto row = scrub_sessions(pair, **probe, **fixed, {seed, 1, i, 1e-4});
        ASSERT_TRUE(row) << row.error().message;
        print_row(stdout, pair, *row);
        for (std::size_t r = 0; r < scrub_rates_hz.size(); ++r) {
          EXPECT_GT(row->stay[r].ticks, 100);
          stay[r] += row->stay[r].rms_m * row->stay[r].rms_m;
          again[r] += row->read_again[r].rms_m * row->read_again[r].rms_m;
        }
      }
    }
  }
  for (std::size_t r = 0; r < scrub_rates_hz.size(); ++r) {
    EXPECT_LT(again[r], 0.25 * stay[r]) << scrub_rates_hz[r] << " Hz";
  }
}

}  // namespace
}  // namespace asperity::presses
