#include "asperity/bake/procedural.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "bake/surface_points.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

const triangle_mesh& block() {
  static const triangle_mesh mesh = shapes::box({0.06, 0.06, 0.02}, {4, 4, 2});
  return mesh;
}

TEST(Procedural, StripesHaveTheirPitchHeightAndDirection) {
  const auto made = make_stripes({0.003, 0.0004, {0.0, 2.0, 0.0}});
  ASSERT_TRUE(made);
  const auto at = [&](double x, double y) { return made->height_m({{x, y, 0.01}, {0, 0, 1}}); };
  EXPECT_NEAR(at(0.0, 0.0), 0.0002, 1e-15);
  EXPECT_NEAR(at(0.02, 0.003), 0.0002, 1e-15);
  EXPECT_NEAR(at(0.01, 0.0015), -0.0002, 1e-15);
  EXPECT_NEAR(at(0.0, 0.00075), 0.0, 1e-15);
}

TEST(Procedural, DotsKeepTheirDistanceAndLeaveNoRoom) {
  const dots asked{0.004, 0.0003, 0.002, 5};
  const auto made = make_dots(asked, block());
  ASSERT_TRUE(made) << made.error().message;
  const relief_extent extent = measure_relief(block(), *made);
  EXPECT_EQ(extent.lowest_m, 0.0);
  EXPECT_GT(extent.highest_m, 0.98 * asked.height_m);
  EXPECT_LE(extent.highest_m, asked.height_m);
  // On the top face, from samples a tenth of a millimetre apart: tops, how near they are to each other, and the largest
  // empty place.
  const auto at = [&](double x, double y) { return made->height_m({{x, y, 0.01}, {0, 0, 1}}); };
  std::vector<vec2> tops;
  constexpr double step = 1e-4;
  for (double x = -0.026; x < 0.026; x += step)
    for (double y = -0.026; y < 0.026; y += step) {
      const double h = at(x, y);
      if (h > 0.9 * asked.height_m && h >= at(x + step, y) && h >= at(x - step, y) && h > at(x, y + step) &&
          h > at(x, y - step))
        tops.emplace_back(x, y);
    }
  // Discs of the pitch's diameter that leave no room cover from 45 to 60 % of a plane.
  const double covered =
      static_cast<double>(tops.size()) * 3.14159 * 0.25 * asked.pitch_m * asked.pitch_m / (0.052 * 0.052);
  EXPECT_GT(covered, 0.42);
  EXPECT_LT(covered, 0.65);
  double nearest = 1.0;
  for (std::size_t i = 0; i < tops.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, glm::length(tops[i] - tops[j]));
  EXPECT_GT(nearest, asked.pitch_m - 3.0 * step);
}

roughness fine_roughness(std::uint64_t seed) {
  roughness out;
  out.rms_m = 12e-6;
  out.spectral_slope = 2.4;
  out.short_m = 0.001;
  out.long_m = 0.04;
  out.seed = seed;
  return out;
}

constexpr double line_m = 0.08;

// Mean power of the heights along lines of one direction, at wavelength line_m / n.
double profile_power(const std::vector<relief>& surfaces, const vec3& along, int n, int samples) {
  constexpr int lines = 8;
  shapes::dice roll(11);
  const vec3 across = glm::cross(vec3(0, 0, 1), along);
  double power = 0.0;
  for (const relief& heights : surfaces)
    for (int line = 0; line < lines; ++line) {
      // One number a statement: the operands of a sum come in any order, and each build would draw other lines.
      const double a = roll(-20.0, 20.0);
      const double b = roll(-20.0, 20.0);
      const double c = roll(-20.0, 20.0);
      const vec3 start = a * across + b * along + vec3(0, 0, c);
      double re = 0.0, im = 0.0;
      for (int i = 0; i < samples; ++i) {
        const double x = (i + 0.5) / samples;
        const double window = 1.0 - std::cos(2.0 * std::numbers::pi * x);
        const double h = window * heights.height_m({start + x * line_m * along, {0, 0, 1}}) / samples;
        re += h * std::cos(2.0 * std::numbers::pi * n * x);
        im += h * std::sin(2.0 * std::numbers::pi * n * x);
      }
      power += re * re + im * im;
    }
  return power;
}

TEST(Procedural, RoughnessHasItsRmsAndItsSpectrumInEveryDirection) {
  std::vector<relief> surfaces;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto made = make_roughness(fine_roughness(seed), block());
    ASSERT_TRUE(made) << made.error().message;
    surfaces.push_back(*made);
  }
  const relief_extent extent = measure_relief(block(), surfaces.front());
  EXPECT_NEAR(extent.rms_m, 12e-6, 12e-12);
  EXPECT_NEAR(extent.mean_m, 0.0, 12e-12);
  // Between wavelengths of 20 mm and 4 mm: a factor of 5, far from the end of the band at 1 mm. Twelve surfaces are an
  // estimate, so that one direction is held less tightly than the mean of all.
  double mean = 0.0;
  for (const vec3& along : {vec3(1, 0, 0), vec3(0.6, 0.8, 0), vec3(0, 1, 0)}) {
    const double fall = profile_power(surfaces, along, 4, 180) / profile_power(surfaces, along, 20, 180);
    const double slope = std::log(fall) / std::log(5.0);
    EXPECT_NEAR(slope, 2.4, 0.4) << along.x;
    mean += slope / 3.0;
  }
  EXPECT_NEAR(mean, 2.4, 0.25);
  // Nothing is finer than the band.
  const std::vector<relief> one(1, surfaces.front());
  EXPECT_LT(profile_power(one, {1, 0, 0}, 100, 400), 1e-4 * profile_power(one, {1, 0, 0}, 20, 400));
}

TEST(Procedural, TheSeedDecides) {
  const relief_point p{{0.011, 0.007, 0.01}, {0, 0, 1}};
  triangle_mesh small = shapes::tetrahedron();
  const auto height = [&](std::uint64_t seed) { return make_roughness(fine_roughness(seed), small)->height_m(p); };
  const double first = height(4);
  EXPECT_EQ(first, height(4));
  EXPECT_NE(first, height(5));
}

TEST(Procedural, RefusesWhatIsOutOfRange) {
  const auto expect_refused = [](const result<relief>& r, const char* says) {
    ASSERT_FALSE(r) << says;
    EXPECT_NE(r.error().message.find(says), std::string::npos) << r.error().message;
  };
  expect_refused(make_stripes({-1.0, 0.1, {1, 0, 0}}), "have to be positive");
  expect_refused(make_stripes({0.1, 0.1, {0, 0, 0}}), "has no length");
  expect_refused(make_dots({0.001, 0.1, 0.002, 1}, block()), "wider than their pitch");
  expect_refused(make_dots({1e-6, 0.1, 1e-6, 1}, block()), "more than a million dots");
  expect_refused(make_roughness({0.0, 2.0, 0.001, 0.01, 1}, block()), "RMS");
  expect_refused(make_roughness({1e-6, 2.0, 0.02, 0.01, 1}, block()), "shorter one first");
  expect_refused(make_roughness({1e-6, 9.0, 0.001, 0.01, 1}, block()), "0 to 6");
}

}  // namespace
}  // namespace asperity::bake
