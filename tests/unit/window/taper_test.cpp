// Weights near the edges of a patch: where they are, that they move with the body, and that nothing jumps.
#include <gtest/gtest.h>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

struct flat_pair {
  scene bodies;
  window_depth_settings settings;
  explicit flat_pair(double probe_half = 0.005) {
    plate_spec a, b;
    a.half_x = a.half_y = probe_half;
    a.cells_x = a.cells_y = 3;
    a.texels = 96;
    b.half_x = b.half_y = 0.02;
    b.texels = 64;
    bodies = {make_plate(a), {make_plate(b)}};
    settings.tau_m = 2e-5;
    settings.taper_m = 1e-3;
  }
  [[nodiscard]] penetration at(const pose& T, double half_window = 0.008) {
    cpu_depth backend(bodies, settings);
    return measure_whole(backend, bodies, window_downwards(half_window), T);
  }
};

TEST(Taper, OnlyOuterEdgesFade) {
  // The face's inner edges have a facing triangle on both sides: without outer edges in reach all weights are 1.
  flat_pair inside(0.015);
  inside.settings.taper_window = false;
  const double cell_m2 = 0.016 * 0.016 / (64.0 * 64.0);
  inside.settings.reference_area_m2 = 64.0 * 64.0 * cell_m2;
  const penetration p = inside.at({face_down(), vec3(0.0, 0.0, -1e-4)});
  EXPECT_NEAR(p.soft_depth_m, 1e-4, 1e-9);  // ln of the mean weight is 0
  EXPECT_EQ(p.samples, 64U * 64U);
}

TEST(Taper, FadesOverItsWidth) {
  // Mean weight of a square of side L with a fade of width w at all four sides: (1 - w / L)^2, as smoothstep has mean
  // 1/2.
  flat_pair pair;
  pair.settings.grid = 256;
  pair.settings.reference_area_m2 = 0.01 * 0.01;
  const penetration p = pair.at({face_down(), vec3(0.0, 0.0, -1e-4)});
  EXPECT_NEAR(p.soft_depth_m, 1e-4 + 2e-5 * std::log(0.9 * 0.9), 4e-7);  // a little less at joints of edges
  EXPECT_NEAR(p.area_m2, 0.01 * 0.01, 2e-6);
}

TEST(Taper, AWallComesIntoViewWithoutAJump) {
  // The probe tips over its edge; at 5.7 degrees the wall starts to face the plane, at 11.5 it counts in full.
  flat_pair pair;
  double last = 0.0, largest_step = 0.0;
  int steps = 0;
  for (double angle = 0.08; angle < 0.24; angle += 0.0005) {
    const double edge = 0.005 * std::sin(angle);
    const double d =
        pair.at({exp_rotation(vec3(angle, 0.0, 0.0)) * face_down(), vec3(0.0, 0.0, edge - 1e-3)}).soft_depth_m;
    if (steps++ > 0) largest_step = std::max(largest_step, std::fabs(d - last));
    last = d;
  }
  // Lever arm 5 mm times 0.5 mrad is 2.5 um; the fade adds its own millimetre times the slope over 0.1 rad.
  EXPECT_LT(largest_step, 6e-6);
  EXPECT_GT(largest_step, 1e-7);
}

TEST(Taper, ASilhouetteThatSlidesOverTheGridChangesNothing) {
  // A flat face that slides over a flat face: depth stays what it is, but for the grid's samples of the fade.
  flat_pair pair(0.0051);  // 40.8 samples wide
  double low = 1.0, high = -1.0, untapered_low = 1.0, untapered_high = -1.0;
  for (int i = 0; i < 50; ++i) {
    const pose T{face_down(), {i * 1e-5, i * 0.7e-5, -1e-4}};
    pair.settings.taper_silhouettes = true;
    const double tapered = pair.at(T).soft_depth_m;
    low = std::min(low, tapered);
    high = std::max(high, tapered);
    pair.settings.taper_silhouettes = false;
    const double hard = pair.at(T).soft_depth_m;
    untapered_low = std::min(untapered_low, hard);
    untapered_high = std::max(untapered_high, hard);
  }
  EXPECT_LT(high - low, 0.02 * (untapered_high - untapered_low));
}

TEST(Taper, TheWindowsBorderFadesTooSoThatAMovingWindowIsSmooth) {
  // A bump enters the window through its border.
  plate_spec a, b;
  a.half_x = a.half_y = b.half_x = b.half_y = 0.02;
  a.texels = b.texels = 1024;
  a.height = [](double x, double y) { return 3e-4 * std::exp(-(x * x + y * y) / 1e-6); };
  const scene s{make_plate(a), {make_plate(b)}};
  window_depth_settings settings;
  settings.tau_m = 6e-6;
  const auto largest_step = [&] {
    cpu_depth backend(s, settings);
    double last = 0.0, step = 0.0;
    for (int i = 0; i <= 100; ++i) {
      const contact_window w = window_downwards(5e-3, vec3(-8e-3 + 5e-5 * i, 0.0, 0.0));
      const double d = measure_whole(backend, s, w, {face_down(), vec3(0.0)}).soft_depth_m;
      if (i > 0) step = std::max(step, std::fabs(d - last));
      last = d;
    }
    return step;
  };
  const double tapered = largest_step();
  settings.taper_window = false;
  EXPECT_LT(tapered, largest_step());
}

}  // namespace
}  // namespace asperity
