// Settings and models that cannot be cut are refused with a sentence; what is made follows the model's size.
#include "asperity/cells/make_surface_cells.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "asperity/cells/cell_scene.hpp"
#include "meshes.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using test_support::bare_model;
using test_support::make_flat_box;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(CellSettings, EachSettingOutOfRangeIsNamed) {
  EXPECT_TRUE(check(cell_settings{}));
  const auto refused = [](double cell_settings::*setting, std::initializer_list<double> values,
                          const std::string& sentence) {
    for (const double v : values) {
      cell_settings s;
      s.*setting = v;
      const result<void> r = check(s);
      ASSERT_FALSE(r) << sentence << ": " << v;
      EXPECT_EQ(r.error().code, error_code::invalid_argument);
      EXPECT_EQ(r.error().message, "cell settings: " + sentence);
      // And the same where it matters.
      const auto made = make_surface_cells(make_flat_box({0.01, 0.01, 0.01}), s);
      ASSERT_FALSE(made);
      EXPECT_EQ(made.error().message, r.error().message);
    }
  };
  const auto angles = {0.0, -0.1, 1.58, nan};
  refused(&cell_settings::sharp_edge_rad, angles, "sharp_edge_rad must lie between 0 and pi/2");
  refused(&cell_settings::cell_angle_rad, angles, "cell_angle_rad must lie between 0 and pi/2");
  refused(&cell_settings::apron_angle_rad, angles, "apron_angle_rad must lie between 0 and pi/2");
  const auto lengths = {-1e-9, nan, infinity};
  refused(&cell_settings::apron_m, lengths, "apron_m must be a finite length, or 0 for automatic");
  refused(&cell_settings::depth_limit_m, lengths, "depth_limit_m must be a finite length, or 0 for automatic");
  refused(&cell_settings::taper_m, lengths, "taper_m must be a finite length, or 0 for automatic");
  refused(&cell_settings::pitch_m, lengths, "pitch_m must be a finite length, or 0 for automatic");
  refused(&cell_settings::sample_pitch_m, lengths, "sample_pitch_m must be a finite length, or 0 for automatic");
  refused(&cell_settings::feature_pitch_m, lengths, "feature_pitch_m must be a finite length, or 0 for automatic");
  refused(&cell_settings::steepest, {0.99, 10.01, nan}, "steepest must lie between 1 and 10");
}

TEST(CellSettings, WhatIsGivenStaysAndWhatIsNotFollowsTheModel) {
  const textured_model box = make_flat_box({0.01, 0.02, 0.03});
  cell_settings given;
  given.apron_m = 1e-3;
  given.depth_limit_m = 2e-3;
  given.taper_m = 3e-4;
  given.pitch_m = 4e-4;
  given.sample_pitch_m = 5e-4;
  given.feature_pitch_m = 6e-4;
  const cell_settings same = resolve(given, box, 1e-3);
  EXPECT_EQ(same.apron_m, 1e-3);
  EXPECT_EQ(same.depth_limit_m, 2e-3);
  EXPECT_EQ(same.taper_m, 3e-4);
  EXPECT_EQ(same.pitch_m, 4e-4);
  EXPECT_EQ(same.sample_pitch_m, 5e-4);
  EXPECT_EQ(same.feature_pitch_m, 6e-4);
  for (const double texel : {0.0, 1e-4, 1e-3}) {
    const cell_settings s = resolve({}, box, texel);
    for (const double length :
         {s.apron_m, s.depth_limit_m, s.taper_m, s.pitch_m, s.sample_pitch_m, s.feature_pitch_m}) {
      EXPECT_GT(length, 0.0);
      EXPECT_LE(length, box.box.diagonal());
    }
    EXPECT_GE(s.pitch_m, 0.5 * texel);
    EXPECT_GE(s.sample_pitch_m, texel);
    EXPECT_GE(s.taper_m, 1.5 * s.pitch_m);
  }
}

TEST(MakeSurfaceCells, RefusesAModelWithoutTexture) {
  textured_model box = make_flat_box({0.01, 0.01, 0.01});
  box.texture = {};
  const auto made = make_surface_cells(box);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::bad_texture);
  EXPECT_EQ(made.error().message, "the model box has no haptic texture to cut in cells");
}

TEST(MakeSurfaceCells, RefusesAModelWithoutArea) {
  textured_model box = make_flat_box({0.01, 0.01, 0.01});
  for (vec3& p : box.mesh.positions) p.y = p.z = 0.0;
  auto made = make_surface_cells(box);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::bad_mesh);
  EXPECT_EQ(made.error().message, "the model box has no coarse triangle with an area");
  box.mesh.triangles.clear();
  made = make_surface_cells(box);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::bad_mesh);
}

TEST(MakeSurfaceCells, RefusesAPitchThatMakesMapsTooLarge) {
  cell_settings fine;
  fine.pitch_m = 1e-9;
  auto made = make_surface_cells(make_flat_box({0.01, 0.01, 0.01}), fine);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::invalid_argument);
  EXPECT_NE(made.error().message.find("pitch_m"), std::string::npos);
  // A model that somebody put together without its box has no size to take a pitch from.
  textured_model boxless = bare_model(test::box_mesh({0.01, 0.01, 0.01}));
  boxless.box = {};
  made = make_surface_cells(boxless);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::invalid_argument);
}

TEST(MakeSurfaceCells, MakesTheSameAtEveryScale) {
  const auto at = [](double scale) {
    auto made = make_surface_cells(make_flat_box(scale * vec3(0.01, 0.012, 0.016), 96));
    EXPECT_TRUE(made);
    return made ? std::move(made).value() : surface_cells{};
  };
  const surface_cells one = at(1.0);
  for (const double scale : {1e-5, 1e-3, 64.0, 1e4}) {  // a tenth of a micrometre to a hundred metres
    const surface_cells other = at(scale);
    ASSERT_EQ(other.cells.size(), one.cells.size());
    EXPECT_EQ(other.edges.size(), 12U);
    EXPECT_NEAR(static_cast<double>(other.samples.size()), static_cast<double>(one.samples.size()),
                0.05 * static_cast<double>(one.samples.size()));
    for (std::size_t c = 0; c < one.cells.size(); ++c) {
      const surface_cell &a = one.cells[c], &b = other.cells[c];
      EXPECT_NEAR(b.depth_limit_m, scale * a.depth_limit_m, 1e-6 * scale * a.depth_limit_m);
      EXPECT_LE(a.lowest_m, a.highest_m);
      EXPECT_LE(b.lowest_m, b.highest_m);
      EXPECT_NEAR(b.highest_m, 0.0, 1e-6 * scale);
      if (a.columns != b.columns || a.rows != b.rows) continue;  // rounding at the last node
      const std::size_t middle = std::size_t{a.rows / 2} * a.columns + a.columns / 2;
      EXPECT_NEAR(other.nodes[b.first + middle].clearance_m, scale * one.nodes[a.first + middle].clearance_m,
                  1e-3 * scale * one.nodes[a.first + middle].clearance_m);
    }
  }
}

TEST(MakeSurfaceCells, TheDepthLimitIsAtMostTheThickness) {
  const auto limit_of = [](const surface_cells& body, const vec3& n) {
    for (const surface_cell& c : body.cells) {
      if (glm::dot(c.n_b, n) > 0.999) return c.depth_limit_m;
    }
    return -1.0;
  };
  cell_settings settings;
  settings.pitch_m = 1e-3;
  settings.depth_limit_m = 4e-3;
  const auto plate = make_surface_cells(bare_model(test::box_mesh({0.02, 0.03, 1e-3})), settings);
  ASSERT_TRUE(plate);
  EXPECT_NEAR(limit_of(plate.value(), {0, 0, 1}), 2e-3, 1e-12);
  EXPECT_NEAR(limit_of(plate.value(), {0, 0, -1}), 2e-3, 1e-12);
  EXPECT_NEAR(limit_of(plate.value(), {1, 0, 0}), 4e-3, 1e-12);  // thick that way
}

TEST(MakeSurfaceCells, OneTriangleIsASurfaceToo) {
  textured_model model = bare_model(test::triangle_mesh_of({vec3(0, 0, 0), vec3(0.02, 0, 0), vec3(0, 0.02, 0)}));
  model.mesh.triangles[0].uv = {vec2(0.25, 0.25), vec2(0.75, 0.25), vec2(0.25, 0.75)};
  cell_settings settings;
  settings.pitch_m = 4e-4;
  const auto made = make_surface_cells(model, settings);
  ASSERT_TRUE(made);
  const surface_cells& sheet = made.value();
  ASSERT_EQ(sheet.cells.size(), 1U);
  EXPECT_NEAR(sheet.cells[0].area_m2, 2e-4, 1e-12);
  EXPECT_EQ(sheet.cells[0].highest_m, 0.0);
  EXPECT_TRUE(sheet.edges.empty());
  EXPECT_EQ(sheet.cells[0].depth_limit_m, sheet.settings.depth_limit_m);
}

TEST(MakeCellScene, CutsAModelOnceHoweverOftenItAppears) {
  const auto a = std::make_shared<const textured_model>(make_flat_box({0.01, 0.01, 0.01}));
  const auto b = std::make_shared<const textured_model>(make_flat_box({0.02, 0.01, 0.01}));
  cell_settings coarse;
  coarse.pitch_m = 1e-3;
  const auto made = make_cell_scene({a, {b, a, b}}, coarse);
  ASSERT_TRUE(made);
  const cell_scene& cut = made.value();
  ASSERT_EQ(cut.fixed.size(), 3U);
  EXPECT_EQ(cut.fixed[1], cut.probe);
  EXPECT_EQ(cut.fixed[0], cut.fixed[2]);
  EXPECT_NE(cut.fixed[0], cut.probe);
}

TEST(MakeCellScene, RefusesASceneWithAModelMissing) {
  const auto box = std::make_shared<const textured_model>(make_flat_box({0.01, 0.01, 0.01}));
  const auto probeless = make_cell_scene({nullptr, {box}});
  ASSERT_FALSE(probeless);
  EXPECT_EQ(probeless.error().message, "the scene has no probe: give it a textured model");
  cell_settings coarse;
  coarse.pitch_m = 1e-3;
  const auto bodyless = make_cell_scene({box, {box, nullptr}}, coarse);
  ASSERT_FALSE(bodyless);
  EXPECT_EQ(bodyless.error().message, "the scene has a fixed body without a model");
  textured_model bare = *box;
  bare.texture = {};
  const auto textureless = make_cell_scene({box, {std::make_shared<const textured_model>(bare)}}, coarse);
  ASSERT_FALSE(textureless);
  EXPECT_EQ(textureless.error().code, error_code::bad_texture);
}

}  // namespace
}  // namespace asperity
