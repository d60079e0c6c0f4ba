// A map holds the fine surface: known reliefs, walls that lean, holes that close.
#include "asperity/cells/cell_relief.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "asperity/cells/make_surface_cells.hpp"
#include "asperity/cells/relief_tap.hpp"
#include "support/height_models.hpp"
#include "support/random_hulls.hpp"

namespace asperity {
namespace {

using namespace test_support;

/// The top face of a plate with its map.
struct top_of {
  surface_cells body;
  const surface_cell* cell = nullptr;

  explicit top_of(const textured_model& plate, double pitch = 1e-4) {
    cell_settings settings;
    settings.pitch_m = pitch;
    settings.apron_m = 1e-3;
    auto made = make_surface_cells(plate, settings);
    EXPECT_TRUE(made);
    if (!made) return;
    body = std::move(made).value();
    for (const surface_cell& c : body.cells) {
      if (c.n_b.z > 0.999) cell = &c;
    }
  }
  [[nodiscard]] detail::relief_tap read(double x, double y) const {
    const vec3 p = cell->to_cell({x, y, 0.0});
    detail::relief_map::place at{};
    const detail::relief_map map(body, *cell);
    EXPECT_TRUE(map.find(p.x, p.y, at));
    return map.read(at);
  }
  /// Height over the plane z = 0 of the body, with its slope along the body's x and y.
  [[nodiscard]] double height(double x, double y) const { return cell->origin_b.z + read(x, y).height_m; }
  [[nodiscard]] vec2 slope(double x, double y) const {
    const detail::relief_tap tap = read(x, y);
    return vec2(tap.height_slope.x * cell->u_b + tap.height_slope.y * cell->v_b);
  }
};

TEST(Relief, AKnownSurfaceIsReproduced) {
  const auto waves = [](double x, double y) { return 1e-4 * std::sin(800.0 * x) + 5e-5 * std::cos(600.0 * y + 1.0); };
  plate_spec spec;
  spec.texels = 400;
  spec.height = waves;
  const top_of top(*make_plate(spec));
  ASSERT_NE(top.cell, nullptr);
  test::uniform_source random(1);
  double worst = 0.0, worst_slope = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double x = random(-0.0099, 0.0099), y = random(-0.0099, 0.0099);
    worst = std::max(worst, std::fabs(top.height(x, y) - waves(x, y)));
    const vec2 slope(0.08 * std::cos(800.0 * x), -0.03 * std::sin(600.0 * y + 1.0));
    worst_slope = std::max(worst_slope, glm::length(top.slope(x, y) - slope));
  }
  std::printf("relief of 0.3 mm: largest error %.2g mm, of its slope %.2g\n", 1e3 * worst, worst_slope);
  EXPECT_LT(worst,
            2e-7);  // texels 50 um apart, drawn as flat triangles: 64 / m * (50 um)^2 / 8 = 0.02 um, and rounding
  EXPECT_LT(worst_slope, 2e-3);
}

TEST(Relief, TheHeightsRangeIsWhatTheSurfaceHas) {
  plate_spec spec;
  spec.height = [](double x, double y) { return 2e-4 * std::sin(500.0 * x) * std::cos(500.0 * y); };
  const top_of top(*make_plate(spec));
  ASSERT_NE(top.cell, nullptr);
  EXPECT_NEAR(top.cell->highest_m - top.cell->lowest_m, 4e-4, 2e-5);
}

TEST(Relief, AWallLeansOutwardsAtTheSlopeLimit) {
  constexpr double step = 5e-4;
  const auto terrace = [](double x, double) { return x < 1e-3 ? step : 0.0; };
  plate_spec spec;
  spec.texels = 400;
  spec.height = terrace;
  constexpr double pitch = 4e-5, texel = 5e-5;
  const top_of top(*make_plate(spec), pitch);
  ASSERT_NE(top.cell, nullptr);
  const double steepest = top.body.settings.steepest;
  for (double x = -3e-3; x < 4e-3; x += 2.3e-5) {
    // Nothing that could be touched is lost; the spline undershoots a kink by some hundredths of a step.
    EXPECT_GT(top.height(x, 3e-4), terrace(x + pitch + texel, 0.0) - 0.07 * steepest * pitch) << x;
    EXPECT_LT(std::fabs(top.slope(x, 3e-4).x), 1.4 * steepest) << x;
  }
  const double foot = 1e-3 + step / steepest;
  EXPECT_NEAR(top.height(foot + 3e-4, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(top.height(0.5 * (1e-3 + foot), 0.0), 0.5 * step, steepest * (pitch + texel));
  const surface_cell& c = *top.cell;
  for (std::uint32_t j = 0; j < c.rows; ++j) {
    for (std::uint32_t i = 0; i + 1 < c.columns; ++i) {
      const relief_node* const n = &top.body.nodes[c.first + std::size_t{j} * c.columns + i];
      ASSERT_LE(std::fabs(n[1].height_m - n[0].height_m), 1.0001 * steepest * c.pitch_m);
    }
  }
}

TEST(Relief, AHoleInTheTextureTakesTheHeightAroundIt) {
  plate_spec spec;
  spec.height = [](double x, double) { return 0.05 * x; };
  textured_model plate = *make_plate(spec);
  int component = 0;
  for (std::uint32_t j = 100; j < 112; ++j) {
    for (std::uint32_t i = 130; i < 140; ++i, component = (component + 1) % 3) {
      glm::vec3& texel = plate.texture.texels[std::size_t{j} * plate.texture.width + i];
      texel[component] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  plate.texture.texels[60 * plate.texture.width + 60].z = std::numeric_limits<float>::infinity();
  const top_of top(plate);
  ASSERT_NE(top.cell, nullptr);
  for (const relief_node& n : top.body.nodes) ASSERT_TRUE(std::isfinite(n.height_m) && std::isfinite(n.clearance_m));
  for (const surface_sample& s : top.body.samples) ASSERT_TRUE(is_finite(vec3(s.position_b)));
  // Texel 134.5, 105.5 of 256 over 20 mm, with a gutter of two.
  const double x = 0.02 * (133.0 / 256.0 - 0.5), y = 0.02 * (104.0 / 256.0 - 0.5);
  EXPECT_NEAR(top.height(x, y), 0.05 * x, 0.05 * 5e-4);
}

TEST(Relief, ATexelFarFromTheModelStaysATexel) {
  plate_spec spec;
  textured_model plate = *make_plate(spec);
  plate.texture.texels[0] = {1e30F, -1e30F, 1e30F};  // in the gutter, which nobody checks
  plate.texture.texels[300] = {1e4F, 0.0F, 0.0F};
  const top_of top(plate, 4e-4);
  ASSERT_NE(top.cell, nullptr);
  EXPECT_NEAR(top.height(0.0, 0.0), 0.0, 1e-6);
}

TEST(Relief, ARegionWithoutATexelLiesOnItsPlane) {
  plate_spec spec;
  textured_model plate = *make_plate(spec);
  for (glm::vec3& p : plate.texture.texels) p.x = std::numeric_limits<float>::quiet_NaN();
  const top_of top(plate);
  ASSERT_NE(top.cell, nullptr);
  for (const relief_node& n : top.body.nodes) ASSERT_EQ(n.height_m, 0.0F);
  EXPECT_TRUE(top.body.samples.empty());
}

}  // namespace
}  // namespace asperity
