// The bound that lets a law skip a group of samples is never below a depth that one of them has.
#include <gtest/gtest.h>
#include <random>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/field/charted_model.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

TEST(BodyFieldBound, HoldsInEveryBallAndIsNotIdle) {
  const std::uint64_t seed = fresh_seed("bound", "2000 balls of 20 points on each of 3 bodies; at length 20000");
  const std::vector<vec2> cup{{0, -0.02},     {0.015, -0.02},    {0.015, 0.02},
                              {0.0125, 0.02}, {0.0125, -0.0175}, {0, -0.0175}};
  const std::vector<textured_model> models{
      make_textured_box({0.02, 0.015, 0.01}, 256, ridges(50e-6, 2e-3)),
      make_flat_box({0.03, 0.03, 0.0005}, 128),
      make_charted_model(turn_outline(cup, 48), 512, [](const vec3& p) { return p; }),
  };
  for (std::size_t m = 0; m < models.size(); ++m) {
    const textured_model& model = models[m];
    const body_field f = built_field(model).value();
    const double diagonal = model.box.diagonal();
    std::mt19937_64 random(seed_of(seed, "bound", m));
    std::uniform_real_distribution<double> unit(-1.0, 1.0), positive(0.0, 1.0);
    std::normal_distribution<double> normal;
    double least = 1.0, loosest = 0.0;
    int dismissed = 0;
    const int balls = extent(2000, 20000);
    for (int i = 0; i < balls; ++i) {
      const double reach = i % 4 == 0 ? 1.5 : 0.6;
      vec3 p = reach * vec3(unit(random), unit(random), unit(random)) * (model.box.high - model.box.low);
      // Some go down to where the distance has a valley, whose sharp bottom the spline lies above: the axis of the cup.
      for (int step = 0; i % 5 == 0 && step < 60; ++step) {
        const vec3 slope = f.coarse(p).slope;
        p -= 0.4 * f.smooth.pitch_m * slope / std::max(1e-9, glm::length(slope));
      }
      const double radius = diagonal * std::pow(10.0, -4.0 + 3.5 * positive(random));
      const double bound = f.most_near(p, radius);
      double most = f.read(p).value_m, smooth = f.coarse(p).value_m;
      for (int k = 0; k < 20; ++k) {
        const vec3 n = glm::normalize(vec3(normal(random), normal(random), normal(random)));
        const vec3 q = p + radius * std::cbrt(positive(random)) * n;
        most = std::max(most, f.read(q).value_m);
        smooth = std::max(smooth, f.coarse(q).value_m);
      }
      least = std::min({least, bound - most, bound - f.highest_relief_m - smooth});
      loosest = std::max(loosest, bound - f.read(p).value_m - 2.0 * radius);
      dismissed += bound < 0.0 ? 1 : 0;
    }
    EXPECT_GE(least, 0.0);
    EXPECT_LE(loosest, 4.5 * f.smooth.pitch_m + f.highest_relief_m - f.lowest_relief_m);
    EXPECT_GT(dismissed, balls / 10);
  }
}

}  // namespace
}  // namespace asperity
