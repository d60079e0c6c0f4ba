// What a motion adds to depths, against exact readings at places drawn anew in each run.
#include "planes/patch_slopes.hpp"

#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "planes/ball_bound.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/field/drawn_places.hpp"

namespace asperity {
namespace {

using namespace test_support;

// Of balls next to the surface, the points that lie as close to it as a reach, each moved within the ball.
TEST(PatchSlopes, NoMotionAddsMore) {
  drawn_places draw{std::mt19937_64(fresh_seed("PatchSlopes.NoMotionAddsMore", "20000 balls at each of 3 bodies"))};
  const std::vector<textured_model> models{make_textured_box({0.012, 0.01, 0.008}, 256, ridges(60e-6, 1.7e-3)),
                                           make_textured_box({0.03, 0.03, 0.01}, 384, ridges(90e-6, 2.3e-3)),
                                           make_flat_box({0.006, 0.009, 0.007}, 128)};
  for (const textured_model& model : models) {
    const field_body body = make_field_body(model).value();
    const body_field& f = body.field;
    const double pitch_m = f.smooth.pitch_m;
    const auto samples = body.samples.samples();
    int known = 0, moved = 0, wrong = 0, sharper = 0;
    double most_wrong_m = 0.0;
    for (int n = 0; n < 20000; ++n) {
      const vec3 on_surface(samples[draw.bits() % samples.size()].position_b);
      const double radius_m = pitch_m * (0.1 + 0.9 * draw.unit()), far_m = radius_m + 0.3 * pitch_m * draw.unit();
      const vec3 middle = on_surface + draw.in_ball(0.8 * pitch_m);
      const depth_bound at = bound_of_ball(f, pose{}, {.centre_b = middle, .radius_m = radius_m, .half_m = radius_m});
      const patch_slopes slopes = slopes_about(f, middle, far_m, at);
      if (slopes.within_m < 0.0) continue;
      ++known;
      for (int i = 0; i < 10; ++i) {
        const vec3 from = middle + draw.in_ball(radius_m), to = middle + draw.in_ball(far_m);
        const patch_way way{.of_middle = to - from};
        const double added_m = f.read(to).value_m - f.read(from).value_m, most_m = slopes.growth_m(way, far_m);
        ++moved;
        wrong += added_m > most_m + 1e-12 ? 1 : 0;
        most_wrong_m = std::max(most_wrong_m, added_m - most_m);
        sharper += most_m < 0.9 * steepest_depth * way.most_m() ? 1 : 0;
      }
    }
    std::printf("  %d of 20000 balls known, %d of %d motions have a sharper bound; %d add more, by up to %.2g um\n",
                known, sharper, moved, wrong, 1e6 * most_wrong_m);
    EXPECT_GT(known, 19000);
    EXPECT_GT(sharper, moved / 2);
    // A measured bound: see "What a motion adds" in wall-that-holds.md.
    EXPECT_LE(wrong, moved / 50000);
    EXPECT_LT(most_wrong_m, 0.1 * pitch_m);
  }
}

// A turn adds what it moves the points of the patch by.
TEST(PatchSlopes, CountsTurnsAndLeaps) {
  const patch_slopes slopes{.measured = {{-0.25, 0.0, 1.0}, {0.5, 0.0, 1.0}}, .within_m = 1e-3};
  constexpr double beside = patch_slopes::not_measured;
  EXPECT_DOUBLE_EQ(slopes.growth_m({{1e-4, 0.0, 0.0}, 0.0}, 1e-3), (0.5 + beside) * 1e-4);
  EXPECT_DOUBLE_EQ(slopes.growth_m({{-1e-4, 0.0, 0.0}, 0.0}, 1e-3), (0.25 + beside) * 1e-4);
  EXPECT_DOUBLE_EQ(slopes.growth_m({{0.0, 0.0, -1e-4}, 0.0}, 1e-3), (-1.0 + beside) * 1e-4);
  EXPECT_DOUBLE_EQ(slopes.growth_m({{1e-4, 0.0, 0.0}, 1e-5}, 1e-3),
                   (0.5 + beside) * 1e-4 + (std::sqrt(0.25 + 1.0) + beside) * 1e-5);
  EXPECT_DOUBLE_EQ(slopes.growth_m({{1e-4, 0.0, 0.0}, 1e-5}, 1.1e-3), steepest_depth * 1.1e-4);
  EXPECT_DOUBLE_EQ(patch_slopes{}.growth_m({{1e-4, 0.0, 0.0}, 0.0}, 0.0), steepest_depth * 1e-4);
}

}  // namespace
}  // namespace asperity
