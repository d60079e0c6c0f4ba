// A field is the same for a body of a millimetre and one of ten metres, and a hundred metres away from its origin.
#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/field/charted_model.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

// A ball with stripes, of radius 1 but for `size`.
textured_model ball(double size, const vec3& middle) {
  plain_mesh mesh = make_icosphere(size, 2);
  for (vec3& p : mesh.positions) p += middle;
  return make_charted_model(mesh, 512, [=](const vec3& p) {
    const vec3 n = glm::normalize(p - middle);
    return middle + size * (1.0 + 2e-3 * std::sin(40.0 * n.z)) * n;
  });
}

struct differences {
  double value = 0.0, slope = 0.0;  // in pitches; of a unit normal
};

// Of two fields of the same ball, wherever both have a direction.
differences between(const body_field& a, double size_a, const body_field& b, double size_b, const vec3& middle_b,
                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.1, 1.1);
  differences out;
  for (int i = 0; i < 20000; ++i) {
    const vec3 q(unit(random), unit(random), unit(random));
    if (glm::length(q) < 0.8) continue;
    const field_reading x = a.read(size_a * q), y = b.read(middle_b + size_b * q);
    out.value = std::max(out.value, std::fabs(x.value_m / a.smooth.pitch_m - y.value_m / b.smooth.pitch_m));
    out.slope = std::max(out.slope, glm::length(x.slope - y.slope));
  }
  return out;
}

TEST(BodyFieldScale, IsTheSameFromAMillimetreToTenMetres) {
  const std::uint64_t seed = fresh_seed("scale", "2 of 5 sizes, 20000 points each; at length all");
  const body_field of_one = built_field(ball(1.0, vec3(0.0))).value();
  std::vector<double> sizes{0.5e-3, 2e-3, 0.03, 0.3, 5.0};
  std::shuffle(sizes.begin(), sizes.end(), std::mt19937_64(seed_of(seed, "sizes")));
  sizes.resize(extent<std::size_t>(2, sizes.size()));
  for (const double size : sizes) {
    const body_field f = built_field(ball(size, vec3(0.0))).value();
    EXPECT_NEAR(f.smooth.pitch_m / size, of_one.smooth.pitch_m, 1e-5 * of_one.smooth.pitch_m);
    const differences d = between(of_one, 1.0, f, size, vec3(0.0), seed);
    std::printf("  radius %g m: values differ by %.5f pitches, slopes by %.5f\n", size, d.value, d.slope);
    EXPECT_LE(d.value, 0.08) << size;  // where two triangles are as near, rounding chooses
    EXPECT_LE(d.slope, 0.1) << size;
  }
}

// Texels are floats: 4 um apart at 60 m, 8 um at 100 m. No more than a few of these is lost.
TEST(BodyFieldScale, IsTheSameAHundredMetresFromTheOrigin) {
  const std::uint64_t seed = fresh_seed("distance", "2 bodies, 20000 points each");
  const vec3 middle(60.0, -50.0, 62.0);
  for (const double size : {0.05, 1.0}) {
    const body_field near = built_field(ball(size, vec3(0.0))).value();
    const textured_model model = ball(size, middle);
    const body_field far = built_field(model).value();
    const zero_errors e = measure_zero(far, model, 20000, seed);
    const differences d = between(near, size, far, size, middle, seed);
    std::printf("  radius %g m: |D| on the surface: median %.2f um, p99 %.2f um; differs by %.2f um, slopes by %.3f\n",
                size, 1e6 * e.median * model.box.diagonal(), 1e6 * e.p99 * model.box.diagonal(),
                1e6 * d.value * near.smooth.pitch_m, d.slope);
    EXPECT_LE(e.median * model.box.diagonal(), 0.6e-6 + 8e-6 * size);
    EXPECT_LE(e.p99 * model.box.diagonal(), 1e-6 + 47e-6 * size);
    EXPECT_LE(d.value * near.smooth.pitch_m, 30e-6 + 0.08 * near.smooth.pitch_m);
  }
}

}  // namespace
}  // namespace asperity
