// Readings in single precision and what bounds a field's third derivatives, against exact readings at places drawn anew in each run.
#include "field/quick_read.hpp"

#include <algorithm>
#include <cmath>
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

const std::vector<body_field>& fields() {
  static const std::vector<body_field> made = [] {
    std::vector<body_field> out;
    out.push_back(built_field(make_textured_box({0.02, 0.015, 0.01}, 256, ridges(50e-6, 2e-3))).value());
    out.push_back(built_field(make_textured_box({0.2, 0.1, 0.15}, 256, ridges(1e-3, 9e-3))).value());
    out.push_back(built_field(make_flat_box({0.03, 0.03, 0.0005}, 128)).value());
    return out;
  }();
  return made;
}

struct places : drawn_places {
  // In the grid and a little beyond it.
  vec3 in(const body_field& f) {
    const detail::coarse_grid& g = f.smooth;
    vec3 out;
    for (int k = 0; k < 3; ++k) {
      const double last = static_cast<double>(g.nodes[static_cast<std::size_t>(k)]) - 1.0;
      out[k] = g.low[k] + g.pitch_m * last * (1.1 * unit() - 0.05);
    }
    return out;
  }
};

TEST(QuickRead, IsWrongByLessThanItSays) {
  places draw{{std::mt19937_64(fresh_seed("QuickRead.IsWrongByLessThanItSays", "20000 points in each of 3 fields"))}};
  for (const body_field& f : fields()) {
    const double extent = f.smooth.pitch_m;
    double worst_slope = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const vec3 p = draw.in(f);
      const coarse_reading exact = f.coarse(p);
      const detail::quick_reading q = detail::quick_read(f.smooth, p);
      EXPECT_LE(std::fabs(q.at.value_m - exact.value_m), 0.1 * q.error_m);
      EXPECT_LE(q.error_m, 1e-4 * extent);
      EXPECT_LT(glm::length(q.at.slope - exact.slope), 5e-6);
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT(glm::length(q.at.hessian_per_m[k] - exact.hessian_per_m[k]), 2e-5 / extent);
      }
      EXPECT_EQ(q.in_grid, f.smooth.clamped(p) == p);
      // A depth read by it, as a sample's is.
      if (!q.in_grid) continue;
      const field_reading relief = f.relief(p, exact), quick = f.relief(p, q.at);
      EXPECT_LE(std::fabs(quick.value_m - relief.value_m), q.error_m + 1e-12);
      worst_slope = std::max(worst_slope, glm::length(quick.slope - relief.slope));
    }
    EXPECT_LT(worst_slope, 1e-4) << "of a slope of the relief, m per m";
  }
}

// The second-order expansion at a point is wrong by at most a sixth of the bound times the distance's cube.
TEST(ThirdBounds, HoldInEveryBall) {
  places draw{{std::mt19937_64(fresh_seed("ThirdBounds.HoldInEveryBall", "20000 balls in each of 3 fields"))}};
  for (const body_field& f : fields()) {
    int known = 0;
    double sharpest = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const vec3 c = draw.in(f);
      const double radius = f.smooth.pitch_m * std::pow(10.0, -1.0 + 1.9 * draw.unit());
      const vec3 low = c - radius, high = c + radius;
      if (f.smooth.clamped(low) != low || f.smooth.clamped(high) != high) continue;
      const double third = f.most_third.most_per_m2(c, radius);
      ASSERT_TRUE(std::isfinite(third));
      ++known;
      const coarse_reading at = f.coarse(c);
      for (int n = 0; n < 5; ++n) {
        const vec3 off = draw.in_ball(radius);
        const double far = glm::length(off);
        const double expanded = at.value_m + glm::dot(at.slope, off) + 0.5 * glm::dot(off, at.hessian_per_m * off);
        const double wrong = std::fabs(f.coarse(c + off).value_m - expanded);
        const double allowed = third * far * far * far / 6.0;
        EXPECT_LE(wrong, allowed + 1e-12);
        if (allowed > 1e-6 * f.smooth.pitch_m) sharpest = std::max(sharpest, wrong / allowed);
      }
    }
    EXPECT_GT(known, 8000);
    EXPECT_GT(sharpest, 0.1) << "a bound that is never near is of no use";
    EXPECT_FALSE(std::isfinite(f.most_third.most_per_m2(f.smooth.low, 9.0 * f.smooth.pitch_m)));
    EXPECT_FALSE(std::isfinite(f.most_third.most_per_m2(f.smooth.low - 1.0, f.smooth.pitch_m)));
  }
}

}  // namespace
}  // namespace asperity
