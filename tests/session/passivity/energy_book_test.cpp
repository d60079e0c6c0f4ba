// The parts of the passivity test that every build can afford: its own book is right, and one session of each kind.
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>

#include "session/passivity/felt_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

// The guard sees measured poses. What it misses is known exactly: the errors of the measurement, summed by parts.
TEST(energy_book, differs_from_the_guard_by_the_errors_of_the_measurement) {
  const ridged_boxes boxes;
  for (const std::int64_t delay_ns : {0, 500'000}) {
    felt_case c = draw_case(7, hand_model::firm, 5'000'000, true, false);
    c.device.measurement = {.position_resolution_m = 2e-5,
                            .rotation_resolution_rad = 1e-4,
                            .delay_ns = delay_ns,
                            .jitter_ns = delay_ns / 5};
    const felt_result r = feel(c, boxes, {.held = true, .guard = false});
    EXPECT_GT(std::fabs(r.observed_gap_j), 1e-5);
    EXPECT_NEAR(r.true_minus_observed_j, r.observed_gap_j, 1e-3 * std::fabs(r.observed_gap_j));
  }
}

// A device whose encoder has no steps and no delay: the guard's book is the truth.
TEST(energy_book, is_the_guards_own_where_poses_are_exact) {
  const ridged_boxes boxes;
  felt_case c = draw_case(7, hand_model::firm, 5'000'000, true, false);
  c.device.measurement = {.position_resolution_m = 0.0, .rotation_resolution_rad = 0.0};
  const felt_result r = feel(c, boxes, {.held = true, .guard = false});
  EXPECT_GT(r.largest_surplus_j, 0.01);
  EXPECT_NEAR(r.true_minus_observed_j, 0.0, 1e-9);
}

TEST(energy_book, keeps_the_bound_in_one_session_of_each_kind) {
  const ridged_boxes boxes;
  std::uint64_t seed = 100'000;
  for (const hand_model hand : {hand_model::soft, hand_model::firm, hand_model::tapping}) {
    for (const bool textured : {false, true}) {
      for (const bool held : {false, true}) {
        const felt_case c = draw_case(seed++, hand, 5'000'000, true, textured);
        const felt_result r = feel(c, boxes, {.held = held, .guard = true});
        EXPECT_GT(r.touching, 0U);
        EXPECT_EQ(r.not_ok, 0U);
        EXPECT_LE(r.largest_surplus_j, r.surplus_bound_j);
        EXPECT_LE(r.largest_gain_j, r.gain_bound_j);
      }
    }
  }
}

}  // namespace
