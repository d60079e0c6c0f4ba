// The solids themselves: closed, of the size that their names say, the same shape plain and fine, and fit for a bake.
#include "support/press_bodies.hpp"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

#include "law/presses/press_pairs.hpp"

namespace asperity::presses {
namespace {

using test_support::bake_press_solid;
using test_support::fineness;
using test_support::make_press_solid;
using test_support::open_edges;
using test_support::volume_m3;

constexpr double pi = std::numbers::pi;

double cone_mm3(double half_angle_deg, int sides) {
  const double slope = std::tan(half_angle_deg * pi / 180.0), h = std::min(20.0, 20.0 / slope), r = slope * h;
  return h / 3.0 * 0.5 * sides * r * r * std::sin(2.0 * pi / sides);
}

struct known_solid {
  std::string name;
  double volume_mm3;
};

const std::vector<known_solid>& exact_solids() {
  static const std::vector<known_solid> all = [] {
    std::vector<known_solid> out{{"slab", 72000.0},
                                 {"plate_5", 18000.0},
                                 {"plate_2", 7200.0},
                                 {"plate_1", 3600.0},
                                 {"rod_8", 60.0 * 4.0 * 2.0 * 2.0 * std::sin(pi / 4.0)},
                                 {"rod_128", 60.0 * 64.0 * 2.0 * 2.0 * std::sin(pi / 64.0)},
                                 {"pyramid_30", cone_mm3(30.0, 4)},
                                 {"groove", 60.0 * 60.0 * 30.0 - 60.0 * 15.0 * 15.0},
                                 {"corner", 50.0 * 50.0 * 50.0 * 7.0 / 8.0},
                                 {"cup", 48.0 * std::sin(pi / 48.0) * (400.0 * 40.0 - 324.0 * 38.0)}};
    for (const int angle : {20, 45, 60}) {
      for (const int sides : {4, 16, 24, 60, 200}) {
        out.push_back({"cone_" + std::to_string(angle) + "_" + std::to_string(sides), cone_mm3(angle, sides)});
      }
    }
    return out;
  }();
  return all;
}

TEST(press_bodies, are_closed_and_as_large_as_their_names_say) {
  for (const auto& [name, volume_mm3] : exact_solids()) {
    for (const fineness how : {fineness::plain, fineness::fine}) {
      const triangle_mesh mesh = make_press_solid(name, how).value();
      EXPECT_EQ(open_edges(mesh), 0U) << name;
      EXPECT_NEAR(volume_m3(mesh) * 1e9, volume_mm3, 1e-6 * volume_mm3) << name;
    }
    EXPECT_LT(make_press_solid(name, fineness::plain)->triangles.size(), 1200U) << name;
    EXPECT_GT(make_press_solid(name, fineness::fine)->triangles.size(), 1200U) << name;
  }
}

TEST(press_bodies, balls_lie_on_their_spheres_and_fine_edges_are_short) {
  for (const int radius : {2, 10, 30}) {
    for (const fineness how : {fineness::plain, fineness::fine}) {
      const triangle_mesh mesh = make_press_solid("ball_" + std::to_string(radius), how).value();
      EXPECT_EQ(open_edges(mesh), 0U);
      for (const vec3& p : mesh.positions) ASSERT_NEAR(glm::length(p), radius * 1e-3, 1e-12);
      const double whole = 4.0 / 3.0 * pi * radius * radius * radius * 1e-9;
      EXPECT_LT(volume_m3(mesh), whole);
      EXPECT_GT(volume_m3(mesh), (how == fineness::fine ? 0.999 : 0.98) * whole);
    }
  }
  for (const char* name : {"slab", "cup", "groove", "corner", "rod_8", "cone_60_4", "ball_30"}) {
    const triangle_mesh mesh = make_press_solid(name, fineness::fine).value();
    double longest = 0.0;
    for (const auto& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        longest = std::max(longest, glm::length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
      }
    }
    EXPECT_LT(longest, 2e-3) << name;
  }
}

// The cone's slopes up to where it meets the prism, the prism's six sides from there on.
TEST(press_bodies, a_pencil_is_the_smaller_of_cone_and_prism) {
  const double slope = std::tan(20.0 * pi / 180.0);
  for (const fineness how : {fineness::plain, fineness::fine}) {
    const triangle_mesh mesh = make_press_solid("pencil", how).value();
    EXPECT_EQ(open_edges(mesh), 0U);
    EXPECT_GT(volume_m3(mesh), 0.0);
    double across = 0.0;
    for (const vec3& p : mesh.positions) {
      const double r = std::hypot(p.x, p.y);
      EXPECT_LE(r, slope * p.z + 1e-12);
      if (p.z > 11e-3) across = std::max(across, r);
    }
    EXPECT_NEAR(across, 4e-3, 1e-12);
  }
}

TEST(press_bodies, other_names_are_refused) {
  for (const char* name :
       {"", "ball", "ball_", "ball_x", "ball_2_3", "ball_-2", "rod_2", "cone_90_4", "slab_3", "egg"}) {
    const auto made = make_press_solid(name, fineness::plain);
    EXPECT_FALSE(made) << name;
    EXPECT_FALSE(test_support::is_press_solid(name));
  }
  EXPECT_TRUE(test_support::is_press_solid("cone_20_60"));
}

TEST(press_bodies, bake_into_models_that_lie_on_them) {
  for (const char* name : {"ball_2", "rod_8", "cone_45_4", "groove"}) {
    const auto own = bake_press_solid(name, press_bake::own_coarse, {});
    ASSERT_TRUE(own) << own.error().message;
    EXPECT_EQ(own->model->mesh.triangles.size(), own->full.triangles.size()) << name;
    EXPECT_LT(own->model->report.max_error_m, 2e-4) << name;
  }
  const std::filesystem::path kept = std::filesystem::temp_directory_path() / "press_bodies_test_models";
  std::filesystem::remove_all(kept);
  const auto made = bake_press_solid("rod_128", press_bake::simplified, kept);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_LE(made->model->mesh.triangles.size(), 600U);
  EXPECT_LT(made->model->report.max_error_m, 3e-4);
  const auto read = bake_press_solid("rod_128", press_bake::simplified, kept);
  ASSERT_TRUE(read);
  const auto &before = made->model->texture.texels, &after = read->model->texture.texels;
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(std::memcmp(after.data(), before.data(), before.size() * sizeof before[0]), 0) << "as it was kept";
  EXPECT_FALSE(bake_press_solid("egg", press_bake::simplified, kept));
  std::filesystem::remove_all(kept);
}

// No pair names a body that nobody makes, and none is there twice.
TEST(press_bodies, every_pair_has_bodies) {
  const auto pairs = press_pairs();
  EXPECT_GE(pairs.size(), 16U);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(pairs[i].name(), pairs[j].name());
  }
}

}  // namespace
}  // namespace asperity::presses
