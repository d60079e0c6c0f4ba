// Measured slopes against exact readings at places drawn anew in each run.
#include "asperity/field/slope_boxes.hpp"

#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/field/drawn_places.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

// Balls up to the largest that are asked about, at most a pitch off the surface.
TEST(SlopeBoxes, HoldTheSlopesOfEveryBall) {
  drawn_places draw{
      std::mt19937_64(fresh_seed("SlopeBoxes.HoldTheSlopesOfEveryBall", "4000 balls on each of 3 bodies"))};
  const std::vector<textured_model> models{make_textured_box({0.02, 0.015, 0.01}, 256, ridges(50e-6, 2e-3)),
                                           make_textured_box({0.2, 0.1, 0.15}, 256, ridges(1e-3, 9e-3)),
                                           make_flat_box({0.03, 0.03, 0.0005}, 128)};
  for (const textured_model& model : models) {
    const body_field f = built_field(model).value();
    const double pitch = f.smooth.pitch_m;
    int known = 0, read = 0, wrong = 0, far_wrong = 0, near = 0;
    double most_wrong = 0.0;
    for (const surface_point& s : random_surface_points(model, 4000, draw.bits())) {
      const vec3 c = s.p_b + pitch * (2.0 * draw.unit() - 1.0) * draw.direction();
      const double radius = pitch * (0.2 + 1.2 * draw.unit());
      const detail::slope_boxes::box box = f.slopes.around(c, radius);
      if (!box.known()) continue;
      ++known;
      for (int i = 0; i < 10; ++i) {
        const vec3 p = c + draw.in_ball(radius);
        const vec3 slope = f.read(p).slope;
        const vec3 low(box.low), high(box.high);
        const double off = glm::length(glm::max(vec3(0.0), glm::max(low - slope, slope - high)));
        ++read;
        wrong += off > 0.05 ? 1 : 0;
        far_wrong += off > 0.3 ? 1 : 0;
        most_wrong = std::max(most_wrong, off);
        // How far to the border of its box, as a share of what is between the borders.
        const vec3 wide = high - low, beside = glm::min(slope - low, high - slope);
        for (int k = 0; k < 3; ++k) near += wide[k] > 0.1 && beside[k] < 0.1 * wide[k] ? 1 : 0;
      }
    }
    std::printf(
        "  %d of 4000 balls known; %d of %d slopes outside by more than 0.05, %d by more than 0.3, by up to %.3f\n",
        known, wrong, read, far_wrong, most_wrong);
    EXPECT_GT(known, 2000);
    // A point's own slope may be outside. What a whole way adds is tested beside patch_slopes, which allows for that.
    EXPECT_LE(wrong, read / 100);
    EXPECT_LE(far_wrong, read / 1000);
    EXPECT_GT(near, read / 20) << "boxes that no slope comes near are of no use";
  }
}

TEST(SlopeBoxes, SayNothingOfWhereNothingWasMeasured) {
  detail::coarse_grid grid;
  grid.pitch_m = 1e-3;
  grid.nodes = {20, 20, 20};
  detail::slope_boxes boxes(grid);
  const vec3 middle(0.005, 0.005, 0.005), slope(0.0, 0.0, 1.0);
  EXPECT_FALSE(boxes.around(middle, 1e-4).known());
  boxes.add(middle, slope);
  boxes.add(middle, {0.3, 0.0, 1.0});
  const detail::slope_boxes::box of = boxes.around(middle, 1e-4);
  EXPECT_EQ(of.low, glm::vec3(0.0F, 0.0F, 1.0F));
  EXPECT_EQ(of.high, glm::vec3(0.3F, 0.0F, 1.0F));
  // Its neighbours have none, nor has what is beside the grid; a leap is not answered.
  EXPECT_FALSE(boxes.around(middle, 1.9e-3).known());
  EXPECT_FALSE(boxes.around(vec3(-0.01), 1e-4).known());
  EXPECT_FALSE(boxes.around(middle, 1.0).known());
  boxes.add(vec3(1.0), slope);  // outside: left out
  EXPECT_FALSE(detail::slope_boxes().around(middle, 1e-4).known());
}

}  // namespace
}  // namespace asperity
