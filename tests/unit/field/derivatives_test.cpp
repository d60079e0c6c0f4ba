// What a field says of its slope and curvature is the derivative of what it says of its value.
#include <gtest/gtest.h>
#include <random>

#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

const body_field& field() {
  static const body_field f = built_field(make_textured_box({0.01, 0.006, 0.004}, 384, ridges(3e-5, 1.3e-3))).value();
  return f;
}

// Points in and around the grid, most of them near the surface.
template <class Check>
void at_random_points(std::string_view name, int count, Check&& check) {
  std::mt19937_64 random(seed_of(fresh_seed(name, "20000 points"), name));
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < count; ++i) {
    const double reach = i % 3 == 0 ? 1.6 : 1.05;
    check(reach * vec3(0.01 * unit(random), 0.006 * unit(random), 0.004 * unit(random)));
  }
}

template <class Function>
double central(Function&& f, const vec3& p, int axis, double h) {
  vec3 e(0.0);
  e[axis] = h;
  // Of fourth order: exact for the cubic pieces of the spline.
  return (8.0 * (f(p + e) - f(p - e)) - (f(p + 2.0 * e) - f(p - 2.0 * e))) / (12.0 * h);
}

// A spline's next derivative jumps at knots, and a difference across one is off by a share of the jump: few may be.
struct tally {
  int all = 0, off = 0;
  double worst = 0.0;
  void count(double difference) {
    ++all;
    off += difference > 1e-6 ? 1 : 0;
    worst = std::max(worst, difference);
  }
};

TEST(BodyFieldDerivatives, OfTheSmoothPart) {
  const double h = 1e-4 * field().smooth.pitch_m;
  tally slopes, bends;
  at_random_points("smooth part", 20000, [&](const vec3& p) {
    const coarse_reading at = field().coarse(p);
    const double scale = 1.0 / field().smooth.pitch_m;
    for (int a = 0; a < 3; ++a) {
      slopes.count(std::fabs(central([&](const vec3& q) { return field().coarse(q).value_m; }, p, a, h) - at.slope[a]));
      for (int b = 0; b < 3; ++b) {
        bends.count(std::fabs(central([&](const vec3& q) { return field().coarse(q).slope[b]; }, p, a, h) -
                              at.hessian_per_m[a][b]) /
                    scale);
        EXPECT_EQ(at.hessian_per_m[a][b], at.hessian_per_m[b][a]);
      }
    }
  });
  // The slope is broken at the border of the grid alone.
  EXPECT_LE(slopes.off, slopes.all / 2000) << slopes.worst;
  EXPECT_LE(bends.off, bends.all / 500) << bends.worst;
}

TEST(BodyFieldDerivatives, OfTheReliefWithItsFootAndFade) {
  tally all;
  double largest = 0.0;
  int faded = 0;
  at_random_points("relief", 20000, [&](const vec3& p) {
    const coarse_reading at = field().coarse(p);
    const field_reading t = field().relief(p, at);
    const double fade = field().foot(p, at).fade;
    faded += fade > 0.01 && fade < 0.99 ? 1 : 0;
    largest = std::max(largest, glm::length(t.slope));
    const double h = 2e-5 * field().fine.pitch_m;
    for (int a = 0; a < 3; ++a) {
      const double d = central([&](const vec3& q) { return field().relief(q, field().coarse(q)).value_m; }, p, a, h);
      all.count(std::fabs(d - t.slope[a]) / std::max(1.0, glm::length(t.slope)));
    }
  });
  EXPECT_GT(largest, 0.1);
  EXPECT_GT(faded, 100);
  EXPECT_LE(all.off, all.all / 200) << all.worst;
  EXPECT_LE(all.worst, 1e-2);
}

TEST(BodyFieldDerivatives, TheWholeIsTheSumOfItsParts) {
  at_random_points("sum", 1000, [&](const vec3& p) {
    const coarse_reading at = field().coarse(p);
    const field_reading t = field().relief(p, at), d = field().read(p);
    EXPECT_EQ(d.value_m, at.value_m + t.value_m);
    EXPECT_EQ(d.slope, at.slope + t.slope);
  });
}

TEST(BodyFieldDerivatives, ContinuousAcrossTheBorderOfTheGridAndFallingBeyond) {
  const detail::coarse_grid& g = field().smooth;
  std::mt19937_64 random(seed_of(fresh_seed("border", "1000 points"), "border"));
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const vec3 way = glm::normalize(vec3(unit(random), unit(random), unit(random)));
    // Where a ray leaves the grid: a face, most often.
    double away = 0.0;
    while (g.clamped((away + 1e-4) * way) == (away + 1e-4) * way) away += 1e-4;
    const vec3 border = g.clamped((away + 1e-4) * way);
    const double just_in = field().coarse(border - 1e-9 * way).value_m;
    const double just_out = field().coarse(border + 1e-9 * way).value_m;
    EXPECT_NEAR(just_in, just_out, 1e-8);
    EXPECT_LT(just_out, -0.5e-3);
    EXPECT_LT(field().read(border + 0.01 * way).value_m, just_out - 1e-3);
    EXPECT_EQ(field().read(border + 0.01 * way).value_m, field().coarse(border + 0.01 * way).value_m);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  static_cast<void>(field().read(vec3(nan, 0.0, 0.0)));  // whatever it is, it must not read outside the nodes
  static_cast<void>(field().read(vec3(std::numeric_limits<double>::infinity())));
  static_cast<void>(field().most_near(vec3(nan), nan));
}

}  // namespace
}  // namespace asperity
