// Settings that are refused, and what the automatic ones come to.
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "asperity/window/cpu_depth.hpp"
#include "asperity/window/window_depth_settings.hpp"
#include "support/height_models.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

TEST(DepthSettings, NameTheOneThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const window_depth_settings& s, const std::string& word) {
    const result<void> r = check(s);
    EXPECT_FALSE(r);
    if (r) return;
    EXPECT_NE(r.error().message.find(word), std::string::npos) << r.error().message;
  };
  EXPECT_TRUE(check(window_depth_settings{}));
  refused({.grid = 1}, "grid");
  refused({.grid = 513}, "grid");
  refused({.tau_m = -1e-6}, "tau_m");
  refused({.tau_m = nan}, "tau_m");
  refused({.reference_area_m2 = nan}, "reference_area_m2");
  refused({.difference_step_m = -1.0}, "difference_step_m");
  refused({.taper_m = nan}, "taper_m");
  refused({.facing_cosine = 0.0}, "facing_cosine");
  refused({.facing_cosine = nan}, "facing_cosine");
}

TEST(MakeCpuDepth, SaysWhatIsWrongWithTheScene) {
  const model_ptr good = make_plate({});
  EXPECT_TRUE(make_cpu_depth({good, {good}}));
  EXPECT_TRUE(make_cpu_depth({good, {}}));
  EXPECT_EQ(make_cpu_depth({nullptr, {good}}).error().code, error_code::invalid_argument);
  EXPECT_EQ(make_cpu_depth({good, {good, nullptr}}).error().code, error_code::invalid_argument);
  EXPECT_EQ(make_cpu_depth({good, {good}}, {.grid = 0}).error().code, error_code::invalid_argument);
  auto untextured = std::make_shared<textured_model>(*good);
  untextured->texture.texels.pop_back();
  EXPECT_EQ(make_cpu_depth({good, {untextured}}).error().code, error_code::bad_texture);
  auto broken = std::make_shared<textured_model>(*good);
  broken->mesh.triangles[0].vertex[1] = 1000000;
  EXPECT_EQ(make_cpu_depth({broken, {good}}).error().code, error_code::bad_mesh);
  auto empty = std::make_shared<textured_model>(*good);
  empty->mesh.triangles.clear();
  EXPECT_EQ(make_cpu_depth({empty, {good}}).error().code, error_code::bad_mesh);
}

/// Box of 20 mm with ridges on four of its faces; on the other two they have a node.
model_ptr ridged(double amplitude, double wavelength) {
  return std::make_shared<const textured_model>(
      make_textured_box(vec3(0.01), 768, test_support::ridges(amplitude, wavelength)));
}

TEST(AutomaticSettings, FollowTheTextures) {
  const model_ptr coarse = ridged(5e-4, 4e-3), fine = ridged(1e-4, 1e-3);
  const auto flat = std::make_shared<const textured_model>(make_flat_box(vec3(0.01)));
  cpu_depth backend({coarse, {fine, flat}});
  // Ridges on two thirds of the surface: the sine of the same mean square has an amplitude of sqrt(2 / 3).
  const double relief = 2.0 * 5e-4 * std::sqrt(2.0 / 3.0);
  EXPECT_NEAR(backend.tau_m(0), 0.02 * relief, 0.01 * 0.02 * relief);
  EXPECT_EQ(backend.tau_m(1), backend.tau_m(0));
  EXPECT_DOUBLE_EQ(cpu_depth({flat, {flat}}).tau_m(0), 2e-5 * flat->box.diagonal());

  // Finest wavelength 1 mm: a twentieth of it where the samples allow, half a pitch where they do not.
  EXPECT_NEAR(backend.difference_step_m(0, 2.4e-3), 0.05e-3, 0.02 * 0.05e-3);
  EXPECT_DOUBLE_EQ(backend.difference_step_m(0, 12.8e-3), 0.2e-3);
  // Never less than half a texel: a face has 252 by 380 of them.
  const double texel = 0.02 / std::sqrt(252.0 * 380.0);
  EXPECT_NEAR(backend.difference_step_m(0, 1e-4), 0.5 * texel, 0.01 * texel);
  // A0 = 2 pi tau / kappa with kappa = a K^2 of either sine.
  const auto curvature = [](double a, double lambda) {
    return a * std::sqrt(2.0 / 3.0) * std::pow(2.0 * std::numbers::pi / lambda, 2);
  };
  const double area = 2.0 * std::numbers::pi * backend.tau_m(0) / (curvature(5e-4, 4e-3) + curvature(1e-4, 1e-3));
  EXPECT_NEAR(backend.reference_area_m2(0), area, 0.03 * area);
  EXPECT_EQ(cpu_depth({coarse, {fine}}, {.tau_m = 1e-5}).tau_m(0), 1e-5);
}

TEST(AutomaticSettings, TheSoftDepthOfATypicalPeakIsItsDepth) {
  // A0 = 2 pi tau / kappa is what a round peak of curvature kappa covers.
  const double radius = 0.02;
  plate_spec ball;
  ball.texels = 1024;
  ball.height = [=](double x, double y) { return -(x * x + y * y) / (2.0 * radius); };
  window_depth_settings settings;
  settings.tau_m = 1e-6;
  settings.reference_area_m2 = 2.0 * std::numbers::pi * 1e-6 * radius;
  settings.grid = 256;
  const scene s{make_plate(ball), {make_plate({})}};
  cpu_depth backend(s, settings);
  const penetration p = measure_whole(backend, s, window_downwards(2e-3), {face_down(), {0.0, 0.0, -1e-4}});
  EXPECT_NEAR(p.soft_depth_m, 1e-4, 1e-8);
}

}  // namespace
}  // namespace asperity
