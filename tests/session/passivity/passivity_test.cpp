// A thousand sessions at length, 288 otherwise: with the guard on, what reaches the hand stays within the stated bound,
// whatever the contact thread does; a held force without the guard breaks it. Prints the table of
// docs/explanation/control-loop.md.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>

#include "session/passivity/felt_session.hpp"
#include "support/extent.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr std::array<const char*, 3> hand_names{"soft", "firm", "tapping"};
// 18 rows: a thousand sessions at length.
const int sessions_per_row = extent(4, 56);
constexpr int one_textured_in = 8;
constexpr double stiff_n_per_m = 2000.0;

/// Sessions that were run in one way.
struct column {
  double largest_surplus_j = 0.0;
  double largest_part_of_bound = 0.0;
  std::uint64_t ticks = 0;
  std::uint64_t acted = 0;
  int broken = 0;

  void add(const felt_result& r) {
    largest_surplus_j = std::max(largest_surplus_j, r.largest_surplus_j);
    largest_part_of_bound = std::max(largest_part_of_bound, r.largest_surplus_j / r.surplus_bound_j);
    ticks += r.ticks;
    acted += r.acted;
    if (r.largest_surplus_j > r.surplus_bound_j || r.largest_gain_j > r.gain_bound_j) ++broken;
    EXPECT_GT(r.ticks, 0U);
    EXPECT_EQ(r.not_ok, 0U);
  }
  [[nodiscard]] double acted_percent() const {
    return 100.0 * static_cast<double>(acted) / static_cast<double>(std::max<std::uint64_t>(1, ticks));
  }
};

TEST(passivity, the_guard_keeps_its_bound_and_a_held_force_without_it_does_not) {
  std::printf(
      "| hand | contact thread | bound | linearised, guard | guard acts | held, guard | guard acts | held, no guard | "
      "breaks it |\n|---|---|---|---|---|---|---|---|---|\n");
  const ridged_boxes boxes;
  std::uint64_t seed = 1;
  int sessions = 0;
  int stiff_late = 0;
  int stiff_late_broken = 0;
  column everywhere;
  column linearised_everywhere;
  for (const hand_model hand : {hand_model::soft, hand_model::firm, hand_model::tapping}) {
    for (const std::int64_t period_ns : {5'000'000, 2'000'000, 1'000'000}) {
      for (const bool late : {false, true}) {
        column linearised;
        column held;
        column bare;
        double least_bound_j = 1.0;
        double largest_bound_j = 0.0;
        for (int i = 0; i < sessions_per_row; ++i, ++seed) {
          const felt_case c = draw_case(seed, hand, period_ns, late, i % one_textured_in == 0);
          const felt_result one = feel(c, boxes, {.held = false, .guard = true});
          const felt_result two = feel(c, boxes, {.held = true, .guard = true});
          // A guard that never acted might as well have been off: the same session, to the bit.
          const felt_result three = two.acted == 0 ? two : feel(c, boxes, {.held = true, .guard = false});
          EXPECT_GT(one.touching, 0U) << "seed " << seed;
          for (const felt_result* r : {&one, &two}) {
            least_bound_j = std::min(least_bound_j, r->surplus_bound_j);
            largest_bound_j = std::max(largest_bound_j, r->surplus_bound_j);
          }
          linearised.add(one);
          held.add(two);
          const int before = bare.broken;
          bare.add(three);
          if (late && period_ns == 5'000'000 && hand == hand_model::firm && c.stiffness_n_per_m >= stiff_n_per_m) {
            ++stiff_late;
            stiff_late_broken += bare.broken - before;
          }
        }
        sessions += sessions_per_row;
        for (const column* k : {&linearised, &held}) {
          EXPECT_EQ(k->broken, 0);
          everywhere.largest_part_of_bound = std::max(everywhere.largest_part_of_bound, k->largest_part_of_bound);
        }
        linearised_everywhere.acted += linearised.acted;
        linearised_everywhere.ticks += linearised.ticks;
        std::printf(
            "| %s | %.0f Hz%s | %.0f to %.0f mJ | %.1f mJ (%.0f %%) | %.2f %% | %.1f mJ (%.0f %%) | %.1f %% | "
            "%.1f mJ | %d of %d |\n",
            hand_names[static_cast<std::size_t>(hand)], 1e9 / static_cast<double>(period_ns), late ? ", late" : "",
            1e3 * least_bound_j, 1e3 * largest_bound_j, 1e3 * linearised.largest_surplus_j,
            100.0 * linearised.largest_part_of_bound, linearised.acted_percent(), 1e3 * held.largest_surplus_j,
            100.0 * held.largest_part_of_bound, held.acted_percent(), 1e3 * bare.largest_surplus_j, bare.broken,
            sessions_per_row);
      }
    }
  }
  std::printf(
      "%d sessions, each run in three ways; with the guard at most %.0f %% of the bound; firm hand, 200 Hz, "
      "late, 2 N/mm and more: a held force without the guard breaks it in %d of %d\n",
      sessions, 100.0 * everywhere.largest_part_of_bound, stiff_late_broken, stiff_late);
  EXPECT_GE(sessions, extent(70, 1000));
  EXPECT_LT(linearised_everywhere.acted_percent(), 1.0);  // a net, not a part of the loop
  // Negative control.
  EXPECT_GE(stiff_late, sessions_per_row / 2);
  EXPECT_GE(3 * stiff_late_broken, 2 * stiff_late);
}

}  // namespace
