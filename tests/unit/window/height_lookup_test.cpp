// Reading the texture: bilinear patches, and the fine point that lies over a sample.
#include "window/height_lookup.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "support/height_models.hpp"
#include "support/sharp_corner.hpp"

namespace asperity::detail {
namespace {

using namespace test_support;

TEST(TextureCell, AgreesWithTheTexturesOwnLookupAndItsDerivatives) {
  plate_spec spec;
  spec.texels = 16;
  spec.height = [](double x, double y) { return 1e-3 * std::sin(400 * x) * std::cos(300 * y + 1.0); };
  const haptic_texture texture = make_plate(spec)->texture;
  std::mt19937_64 bits(5);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  for (int i = 0; i < 2000; ++i) {
    const vec2 uv{1.1 * uniform() - 0.05, 1.1 * uniform() - 0.05};  // a little beyond the image too
    const vec2 z = uv * vec2(texture.width, texture.height) - 0.5;
    EXPECT_LT(glm::length(read(texture, z).point - texture.sample(uv)), 1e-15);
    const texture_cell cell(texture, z);
    EXPECT_TRUE(cell.holds(z));
    if (std::fabs(z.x - std::round(z.x)) < 1e-4 || std::fabs(z.y - std::round(z.y)) < 1e-4) continue;
    if (z.x < 0 || z.y < 0 || z.x > texture.width - 1 || z.y > texture.height - 1) continue;
    const double h = 1e-5;
    const surface_tap tap = read(texture, z);
    const vec3 by_x = (read(texture, z + vec2(h, 0)).point - read(texture, z - vec2(h, 0)).point) / (2.0 * h);
    const vec3 by_y = (read(texture, z + vec2(0, h)).point - read(texture, z - vec2(0, h)).point) / (2.0 * h);
    EXPECT_LT(glm::length(tap.along_x - by_x), 1e-11);
    EXPECT_LT(glm::length(tap.along_y - by_y), 1e-11);
  }
}

TEST(TextureCell, WorksOnASingleTexel) {
  const haptic_texture texture{1, 1, {glm::vec3(1.0F, 2.0F, 3.0F)}};
  const surface_tap tap = read(texture, {0.3, -4.0});
  EXPECT_EQ(tap.point, vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(tap.along_x, vec3(0.0));
}

struct lookup {
  model_ptr model;
  surface_index index{*model};
  patch_projection patch{model->mesh.triangles.size()};
  height_field field{48 * 48};

  /// Looks up all samples of a window and returns how many were found over the sample itself.
  std::size_t run(const contact_window& w, const pose& T, parallax_mode mode) {
    const window_map map(w, T);
    const sample_grid grid(48, w.half_size_m);
    patch.project(model->mesh, index, all_triangles(*model), map, layer::highest, 0.1);
    rasterise(patch, grid, layer::highest, field);
    EXPECT_TRUE(
        look_up(body_view{model->texture, index, patch, map}, grid, mode, field, [](std::size_t) { return true; }));
    return static_cast<std::size_t>(std::count(field.kind.begin(), field.kind.end(), hit::above));
  }
};

height_function waves(double amplitude) {
  return [=](double x, double y) { return amplitude * (std::cos(1500 * x + 0.4) + std::sin(1100 * y - 600 * x)); };
}

TEST(HeightLookup, ExactFindsThePointOverTheSampleAcrossChartSeams) {
  for (const bool seams : {false, true}) {
    plate_spec spec;
    spec.cells_x = 6;
    spec.cells_y = 5;
    spec.texels = 1500;
    spec.chart_per_cell = seams;
    spec.height = waves(3e-4);
    lookup l{make_plate(spec)};
    const contact_window w = window_downwards(5e-3);
    const sample_grid grid(48, w.half_size_m);
    for (const double tilt : {0.0, 0.05, 0.2}) {
      const pose T{exp_rotation(vec3(tilt, -0.5 * tilt, 0.7)) * face_down(), vec3(0.0)};
      EXPECT_EQ(l.run(w, T, parallax_mode::exact), grid.size()) << "tilt " << tilt << (seams ? " seams" : "");
      const window_map map(w, T);
      double worst_side = 0.0, worst_height = 0.0;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const vec3 found = map.point(read(l.model->texture, l.field.texel[i]).point);
        const vec2 uv = grid.position(i);
        worst_side = std::max({worst_side, std::fabs(found.x - uv.x), std::fabs(found.y - uv.y)});
        // Back in the plate's own frame the point must lie on the height function itself.
        const vec3 p_b = inverse(T) * to_world(w, vec3(uv, l.field.height[i]));
        worst_height = std::max(worst_height, std::fabs(p_b.z - spec.height(p_b.x, p_b.y)));
      }
      EXPECT_LT(worst_side, 1e-9) << "tilt " << tilt;
      EXPECT_LT(worst_height, 3e-8) << "curvature 1150 per m times texel^2 / 8";
    }
  }
}

TEST(HeightLookup, ThePapersLookupMissesByTheParallaxThatExactRemoves) {
  plate_spec spec;
  spec.texels = 1024;
  spec.height = waves(3e-4);
  lookup l{make_plate(spec)};
  const contact_window w = window_downwards(5e-3);
  const pose T{exp_rotation(vec3(0.2, 0.0, 0.0)) * face_down(), vec3(0.0)};
  EXPECT_EQ(l.run(w, T, parallax_mode::paper_lookup), 0U);
  const sample_grid grid(48, w.half_size_m);
  const window_map map(w, T);
  double worst = 0.0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const vec2 uv = grid.position(i);
    EXPECT_EQ(l.field.kind[i], hit::beside);
    const projected_triangle& t = l.patch.triangles()[l.field.owner[i]];
    EXPECT_EQ(l.field.texel[i], vec2(t.texel_x(uv.x, uv.y), t.texel_y(uv.x, uv.y)));
    const vec3 found = map.point(read(l.model->texture, l.field.texel[i]).point);
    EXPECT_DOUBLE_EQ(l.field.height[i], found.z);
    worst = std::max(worst, std::hypot(found.x - uv.x, found.y - uv.y));
  }
  EXPECT_GT(worst, 0.2 * 4e-4);  // height times tilt
}

TEST(HeightLookup, OnAFoldItFindsOneOfThePoints) {
  // Walls of slope 12 seen at a slant of 0.3 rad overhang: up to three points lie over a sample.
  plate_spec spec;
  spec.texels = 2048;
  spec.height = [](double x, double) { return 4e-4 * std::tanh(12.0 / 4e-4 * (std::fabs(x) - 2e-3)); };
  lookup l{make_plate(spec)};
  const contact_window w = window_downwards(5e-3);
  const pose T{exp_rotation(vec3(0.0, 0.3, 0.0)) * face_down(), vec3(0.0)};
  const std::size_t above = l.run(w, T, parallax_mode::exact);
  EXPECT_GT(above, l.field.kind.size() / 2);
  const sample_grid grid(48, w.half_size_m);
  const window_map map(w, T);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const vec3 found = map.point(read(l.model->texture, l.field.texel[i]).point);
    const vec2 uv = grid.position(i);
    if (l.field.kind[i] == hit::above) {
      EXPECT_LT(std::hypot(found.x - uv.x, found.y - uv.y), 1e-9);
    }
    EXPECT_NEAR(l.field.height[i], found.z, 2e-8);
  }
}

TEST(HeightLookup, WhereThePatchEndsFirstThePapersLookupStandsIn) {
  // A face that stands 3 mm off its coarse one: seen at 0.08 rad it ends 0.24 mm before the coarse footprint does, and
  // the wall beyond does not face the window.
  plate_spec spec;
  spec.half_x = spec.half_y = 4e-3;
  spec.height = [](double, double) { return 3e-3; };
  lookup l{make_plate(spec)};
  const contact_window w = window_downwards(5e-3);
  const std::size_t above =
      l.run(w, {exp_rotation(vec3(0.0, 0.08, 0.0)) * face_down(), vec3(0.0)}, parallax_mode::exact);
  const auto beside = static_cast<std::size_t>(std::count(l.field.kind.begin(), l.field.kind.end(), hit::beside));
  const std::size_t side = static_cast<std::size_t>(std::lround(8e-3 / (1e-2 / 48)));
  EXPECT_GT(above, 30 * side);
  EXPECT_GE(beside, side / 2);
  EXPECT_LE(beside, 3 * side);
  for (const double h : l.field.height) EXPECT_TRUE(std::isfinite(h));
}

TEST(HeightLookup, PastASharpCornerThePapersLookupStandsIn) {
  // Beyond the chart: nothing, and another one, 5 mm higher.
  for (const double other : {std::numeric_limits<double>::quiet_NaN(), 5e-3}) {
    lookup l{sharp_corner(vec3(0.0, 0.0, other))};
    const contact_window w = window_downwards(8e-4, vec3(7e-4, 0.0, 0.0));
    const std::size_t above = l.run(w, {face_down(), vec3(0.0)}, parallax_mode::exact);
    const auto beside = static_cast<std::size_t>(std::count(l.field.kind.begin(), l.field.kind.end(), hit::beside));
    std::size_t covered = 0;
    const sample_grid grid(48, w.half_size_m);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double x = grid.position(i).x + 7e-4;
      const bool there = x > 0.0 && std::fabs(grid.position(i).y) < x * std::tan(6.0 * std::numbers::pi / 180.0);
      covered += there ? 1 : 0;
      if (l.field.kind[i] != hit::none) {
        EXPECT_NEAR(l.field.height[i], 1e-4, 1e-9) << x;
      }
    }
    EXPECT_NEAR(static_cast<double>(above + beside), static_cast<double>(covered), 2.0);
    EXPECT_GT(beside, 5U);
    EXPECT_GT(above, 3 * beside);
  }
}

// A face whose chart fills the image, so that its outermost half texel has no cell of its own. The textured surface
// stands 0.8 texels beside the coarse one: what lies over that strip begins inside the image.
model_ptr face_to_the_images_border() {
  constexpr double texel_m = 1e-4;
  constexpr std::uint32_t side = 16;
  textured_model m;
  m.texture.width = m.texture.height = side;
  for (const vec2& uv : {vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1)}) {
    m.mesh.positions.emplace_back(texel_m * side * vec3(uv - 0.5, 0.0));
  }
  m.mesh.triangles.push_back({.vertex = {0, 1, 2}, .uv = {vec2(0, 0), vec2(1, 0), vec2(1, 1)}});
  m.mesh.triangles.push_back({.vertex = {0, 2, 3}, .uv = {vec2(0, 0), vec2(1, 1), vec2(0, 1)}});
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i) {
      const double x = i + 0.5 - 0.5 * side, y = j + 0.5 - 0.5 * side;
      m.texture.texels.emplace_back(texel_m * vec3(x - 0.8, y, 0.1 * x));
    }
  }
  m.box = {m.mesh.positions.front(), m.mesh.positions[2]};
  return std::make_shared<const textured_model>(std::move(m));
}

TEST(HeightLookup, AtTheImagesBorderExactFindsThePointOverTheSampleToo) {
  lookup l{face_to_the_images_border()};
  const contact_window w = window_downwards(8e-4);
  const pose T{face_down(), vec3(0.0)};
  const std::size_t above = l.run(w, T, parallax_mode::exact);
  const sample_grid grid(48, w.half_size_m);
  const window_map map(w, T);
  std::size_t from_beyond = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (l.field.kind[i] != hit::above) continue;
    const vec2 uv = grid.position(i);
    const vec3 found = map.point(read(l.model->texture, l.field.texel[i]).point);
    EXPECT_LT(std::hypot(found.x - uv.x, found.y - uv.y), 1e-9) << "texel " << l.field.texel[i].x;
    EXPECT_NEAR(l.field.height[i], found.z, 1e-9);
    const projected_triangle& t = l.patch.triangles()[l.field.owner[i]];
    from_beyond += t.texel_x(uv.x, uv.y) < 0.0 ? 1U : 0U;
  }
  EXPECT_GT(from_beyond, 20U);
  EXPECT_GT(above, grid.size() / 2);
}

}  // namespace
}  // namespace asperity::detail
