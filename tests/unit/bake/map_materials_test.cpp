// Maps of materials laid on baked models: each texel is of the colour that the image has there.
#include "asperity/bake/map_materials.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "asperity/model/validate.hpp"
#include "mapped_shapes.hpp"

namespace asperity::bake {
namespace {

const shapes::wavy_slab waves;

const textured_model& waves_model() {
  static const textured_model model = [] {
    bake_settings settings;
    settings.name = "slab";
    settings.texture_size = 256;
    settings.triangles = 200;
    settings.threads = 2;
    auto r = bake(waves.mesh(24), settings);
    EXPECT_TRUE(r) << r.error().message;
    return *r;
  }();
  return model;
}

const std::vector<material_colour> two{{{0, 0, 0}, *preset_material("ice")}, {{255, 0, 0}, *preset_material("rubber")}};

// Left and right halves, in grey, in colour, and blurred over a quarter of the image: the nearest colour counts.
TEST(MapOfMaterials, EachTexelIsOfItsColour) {
  const triangle_mesh full = waves.mesh(24);
  const std::vector<material_colour> greys{{{10, 10, 10}, *preset_material("ice")},
                                           {{200, 200, 200}, *preset_material("rubber")}};
  const auto half = [](double u, double low, double high, double over) {
    const double share = over > 0.0 ? std::min(1.0, std::max(0.0, 0.5 + (u - 0.5) / over)) : (u > 0.5 ? 1.0 : 0.0);
    return low + share * (high - low);
  };
  const std::array<map_image, 3> images{shapes::make_map(128, 1, 8,
                                                         [&](double u, double) {
                                                           return std::array{half(u, 10 / 255., 200 / 255., 0), 0., 0.};
                                                         }),
                                        shapes::make_map(64, 3, 8,
                                                         [&](double u, double) {
                                                           return std::array{half(u, 0, 1, 0), 0., 0.};
                                                         }),
                                        shapes::make_map(128, 3, 16, [&](double u, double) {
                                          return std::array{half(u, 0, 1, 0.25), 0., 0.};
                                        })};
  for (std::size_t i = 0; i < images.size(); ++i) {
    textured_model model = waves_model();
    const auto laid = lay_materials(model, full, images[i], i == 0 ? greys : two, {.threads = 2});
    ASSERT_TRUE(laid) << laid.error().message;
    EXPECT_EQ(laid->surface.name, "ice");
    EXPECT_EQ(laid->far_share > 0.05, i == 2);
    model.surface = laid->surface;
    model.surface_map = laid->map;
    EXPECT_TRUE(validate(model));
    std::size_t wrong = 0, all = 0;
    for (std::size_t t = 0; t < model.texture.texels.size(); ++t) {
      const vec3 p(model.texture.texels[t]);
      if (!is_finite(p) || std::fabs(p.x) < 7e-4 || std::fabs(p.x) > 0.5 * waves.side_m) continue;
      ++all;
      wrong += (p.x > 0.0) != (model.surface_map.texels[t] == 1) ? 1U : 0U;
    }
    EXPECT_GT(all, 10'000U);
    EXPECT_EQ(wrong, 0U) << i;
    const std::vector<double> shares = material_shares(model);
    EXPECT_NEAR(shares[0], 0.5, 0.01);
    EXPECT_EQ(lay_materials(waves_model(), full, images[i], i == 0 ? greys : two, {.threads = 1})->map.texels,
              laid->map.texels);
  }
}

TEST(MapOfMaterials, WhatDoesNotFitIsRefused) {
  const map_image image = shapes::make_map(8, 3, 8, [](double, double) { return std::array{0., 0., 0.}; });
  const auto expect_refused = [&](const triangle_mesh& mesh, const map_image& map, std::vector<material_colour> colours,
                                  error_code code, const char* why) {
    const auto laid = lay_materials(waves_model(), mesh, map, colours);
    ASSERT_FALSE(laid) << why;
    EXPECT_EQ(laid.error().code, code);
    EXPECT_NE(laid.error().message.find(why), std::string::npos) << laid.error().message;
  };
  const triangle_mesh full = waves.mesh(4);
  triangle_mesh bare = full;
  bare.uvs.clear();
  expect_refused(bare, image, two, error_code::bad_mesh, "the mesh has no texture coordinates");
  expect_refused(full, map_image{}, two, error_code::bad_texture, "no image of one or three channels");
  expect_refused(full, image, {two[0]}, error_code::invalid_argument, "2 to 8 colours, and 1 are listed");
  expect_refused(full, image, std::vector<material_colour>(9, two[0]), error_code::invalid_argument, "9 are listed");
  expect_refused(full, image, {two[0], two[1], two[0]}, error_code::invalid_argument, "listed twice");
  std::vector<material_colour> bad = two;
  bad[1].is.static_friction = -1.0;
  expect_refused(full, image, bad, error_code::invalid_argument, "the static friction must be");
  EXPECT_EQ(lay_materials(waves_model(), full, image, two, {.keep_going = [] { return false; }}).error().code,
            error_code::cancelled);
}

}  // namespace
}  // namespace asperity::bake
