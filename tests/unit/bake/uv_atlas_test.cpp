// Texture coordinates that come with a mesh, as an atlas: what is taken as it is, and what is refused with its mend.
#include "bake/uv_atlas.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "bake/geometry.hpp"
#include "mapped_shapes.hpp"

namespace asperity::bake {
namespace {

constexpr std::uint32_t side = 256;
using shapes::wavy_slab;

triangle_mesh slab() { return wavy_slab::unwrapped(2, 0.004, 0.002); }

// Texels per metre of that slab.
constexpr double slab_scale(std::uint32_t size) { return size / (2.0 * wavy_slab::side_m + 0.004 + 2.0 * 0.002); }

void expect_refused(const triangle_mesh& mesh, std::initializer_list<const char*> says,
                    error_code code = error_code::bad_mesh, std::uint32_t size = side) {
  const auto r = atlas_from_uvs(mesh, size);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, code) << r.error().message;
  for (const char* part : says)
    EXPECT_NE(r.error().message.find(part), std::string::npos) << part << ": " << r.error().message;
}

void transform(triangle_mesh& mesh, const std::function<vec2(const vec2&)>& f) {
  for (auto& t : mesh.uvs)
    for (vec2& p : t) p = f(p);
}

// A cube unfolded into a cross: one chart with four inner corners.
triangle_mesh cross() {
  constexpr double a = 0.04;
  triangle_mesh out = shapes::box(vec3(a), {1, 1, 1});
  for (const auto& t : out.triangles) {
    const vec3 n = glm::cross(out.positions[t[1]] - out.positions[t[0]], out.positions[t[2]] - out.positions[t[0]]);
    auto& uv = out.uvs.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3 p = out.positions[t[k]];
      const double down = 0.5 * a - p.z;
      uv[k] = n.z > 0.0   ? vec2(p.x, p.y)
              : n.x > 0.0 ? vec2(0.5 * a + down, p.y)
              : n.x < 0.0 ? vec2(-0.5 * a - down, p.y)
              : n.y > 0.0 ? vec2(p.x, 0.5 * a + down)
              : n.y < 0.0 ? vec2(p.x, -0.5 * a - down)
                          : vec2(2.0 * a - p.x, p.y);
      uv[k] = vec2(0.4, 0.5) + 0.9 / (4.0 * a) * uv[k];
    }
  }
  return out;
}

TEST(UvAtlas, KeepsWhatItIsGiven) {
  const triangle_mesh mesh = slab();
  const auto r = atlas_from_uvs(mesh, side);
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(r->charts, 6U);
  std::size_t mirrored = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const vec2 a = r->uv[t][1] - r->uv[t][0], b = r->uv[t][2] - r->uv[t][0];
    mirrored += a.x * b.y - a.y * b.x < 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(glm::length(r->uv[t][k] - mesh.uvs[t][k]), 0.0, 1e-7);
      EXPECT_EQ(r->uv[t][k].x, to_float32(r->uv[t][k].x));
    }
  }
  EXPECT_GT(mirrored, 0U);
  EXPECT_LT(mirrored, mesh.triangles.size());
  const double texel_m = 1.0 / slab_scale(side);
  for (const double edge : {r->texel_m, r->narrow_m, r->wide_m}) EXPECT_NEAR(edge, texel_m, 1e-4 * texel_m);
  const double area = 2.0 * 0.04 * 0.04 + 4.0 * 0.04 * 0.008;
  EXPECT_NEAR(r->utilisation, area * slab_scale(1) * slab_scale(1), 1e-5);
  EXPECT_TRUE(distortion_remark(*r).empty());
}

TEST(UvAtlas, TakesACrossAsOneChart) {
  const auto r = atlas_from_uvs(cross(), side);
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(r->charts, 1U);
}

TEST(UvAtlas, TellsOfStretch) {
  const shapes::mapped_torus torus;
  triangle_mesh mesh = torus.mesh(48, 32);
  transform(mesh, [](const vec2& p) { return 0.05 + 0.9 * p; });
  const auto r = atlas_from_uvs(mesh, side);
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(r->charts, 1U);
  const double texels = 0.9 * side;
  const double outside = shapes::two_pi * (torus.major_m + torus.minor_m) / texels;
  const double across = shapes::two_pi * torus.minor_m / texels;
  EXPECT_NEAR(r->wide_m, outside, 0.03 * outside);
  EXPECT_NEAR(r->narrow_m, across, 0.03 * across);
  EXPECT_NEAR(r->texel_m, shapes::two_pi * std::sqrt(torus.major_m * torus.minor_m) / texels, 0.01 * r->texel_m);
  EXPECT_NE(distortion_remark(*r).find("stretch the texels"), std::string::npos);
}

// The same cut in one face, its sides a texel apart, or with the halves exchanged.
TEST(UvAtlas, LetsTheSidesOfASeamBeNear) {
  triangle_mesh mesh = slab();
  const auto open_top = [&](double texels) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      double x = 0.0, z = 0.0;
      for (const std::uint32_t v : mesh.triangles[t]) {
        x += mesh.positions[v].x;
        z += mesh.positions[v].z;
      }
      if (z < 2.9 * wavy_slab::half_thickness_m || x < 0.0) continue;
      for (vec2& p : mesh.uvs[t]) p.x += texels / side;
    }
  };
  open_top(1.0);
  const auto r = atlas_from_uvs(mesh, side);
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(r->charts, 7U);
}

TEST(UvAtlas, RefusesWhatIsNoPlace) {
  triangle_mesh bare = slab();
  bare.uvs.clear();
  expect_refused(bare, {"no texture coordinates to keep", "--keep-uvs"});
  triangle_mesh some = slab();
  some.uvs.pop_back();
  expect_refused(some, {"no texture coordinates to keep"});
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    triangle_mesh mesh = slab();
    mesh.uvs[7][1].y = x;
    expect_refused(mesh, {"triangle 7 ", "not a number"});
  }
  for (const double x : {1.25, -0.001, 1e300}) {
    triangle_mesh mesh = slab();
    mesh.uvs[3][2].x = x;
    expect_refused(mesh, {"triangle 3 ", "outside the unit square", "does not repeat"});
  }
}

TEST(UvAtlas, RefusesTheBorderOfTheImage) {
  triangle_mesh mesh = wavy_slab::unwrapped(1, 0.004, 0.0);
  expect_refused(mesh, {"half a texel from the border", "margin of 0.00195"});
  transform(mesh, [](const vec2& p) { return vec2(0.5) + (p - 0.5) * (1.0 - 1.0 / side); });
  EXPECT_TRUE(atlas_from_uvs(mesh, side));
}

TEST(UvAtlas, RefusesTrianglesWithoutArea) {
  triangle_mesh point = slab();
  point.uvs[5] = {vec2(0.5), vec2(0.5), vec2(0.5)};
  expect_refused(point, {"triangle 5 ", "no area"});
  triangle_mesh line = slab();
  line.uvs[6] = {vec2(0.1, 0.1), vec2(0.2, 0.2), vec2(0.3, 0.3)};
  expect_refused(line, {"triangle 6 ", "no area"});
}

TEST(UvAtlas, RefusesMirroredHalvesThatShareTexels) {
  const double width = (wavy_slab::side_m + 0.004) * slab_scale(1);
  triangle_mesh mesh = slab();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    double z = 0.0;
    for (const std::uint32_t v : mesh.triangles[t]) z += mesh.positions[v].z;
    if (z > -2.9 * wavy_slab::half_thickness_m) continue;
    for (vec2& p : mesh.uvs[t]) p.x -= width;  // the bottom onto the top
  }
  expect_refused(mesh, {"overlap", "mirrored halves", "triangles "});
}

TEST(UvAtlas, RefusesAFoldInsideAChart) {
  // The middle of the top goes beyond the top's border: two of its triangles turn over.
  triangle_mesh mesh = slab();
  vec2 middle(0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3& p = mesh.positions[mesh.triangles[t][k]];
      if (p.x == 0.0 && p.y == 0.0 && p.z > 0.0) middle = mesh.uvs[t][k];
    }
  transform(mesh, [&](const vec2& p) {
    return p == middle ? vec2(p.x + 0.51 * wavy_slab::side_m * slab_scale(1), p.y + 1e-3) : p;
  });
  expect_refused(mesh, {"overlap"});
}

TEST(UvAtlas, RefusesChartsThatAreTooNear) {
  constexpr double gap_m = 2e-4;
  const triangle_mesh mesh = wavy_slab::unwrapped(2, gap_m, 0.002);
  const double gap = gap_m / (2.0 * wavy_slab::side_m + gap_m + 2.0 * 0.002);
  const auto enough = static_cast<std::uint32_t>(std::ceil(4.0 / gap));
  const std::string option = "--texture " + std::to_string(enough);
  expect_refused(mesh, {"not neighbours", "nearer than the 4", option.c_str(), "margin of 0.0156"});
  EXPECT_TRUE(atlas_from_uvs(mesh, enough)) << "the size that was named is enough";
  // Charts that touch: no size would do.
  const auto touching = atlas_from_uvs(wavy_slab::unwrapped(2, 0.0, 0.002), side);
  ASSERT_FALSE(touching);
  EXPECT_EQ(touching.error().message.find("--texture"), std::string::npos) << touching.error().message;
  EXPECT_NE(touching.error().message.find("margin of 0.0156"), std::string::npos) << touching.error().message;
}

TEST(UvAtlas, RefusesATextureThatIsTooSmall) {
  triangle_mesh mesh = shapes::mapped_torus{}.mesh(48, 32);
  transform(mesh, [](const vec2& p) { return 0.05 + 0.9 * p; });
  expect_refused(mesh, {"larger texture"}, error_code::invalid_argument, 32);
}

TEST(UvAtlas, RefusesNeedlesAcrossTheImage) {
  // A fan of long triangles along the diagonal: their boxes are the image, over and over.
  triangle_mesh mesh = shapes::mapped_torus{}.mesh(20, 14);
  const double step = 1.6 / static_cast<double>(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double at = 0.1 + 0.5 * step * static_cast<double>(t);
    mesh.uvs[t] = {vec2(at, 1.0 - at), vec2(at + 0.5 * step, 1.0 - at - 0.5 * step), vec2(0.95, 0.95)};
  }
  const auto r = atlas_from_uvs(mesh, 128);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, error_code::limit_exceeded) << r.error().message;
}

// Whatever the numbers are: a sentence, or an atlas whose charts keep apart. The sizes are where faults hide.
TEST(UvAtlas, SurvivesAnyNumbers) {
  shapes::dice roll(5);
  const double odd[] = {0.0,
                        1.0,
                        0.5,
                        -0.0,
                        1e-320,
                        1e300,
                        -1e300,
                        std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity()};
  std::size_t taken = 0, refused = 0;
  for (int round = 0; round < 400; ++round) {
    triangle_mesh mesh = slab();
    const std::size_t changes = roll.below(6);
    for (std::size_t i = 0; i < changes; ++i) {
      vec2& p = mesh.uvs[roll.below(mesh.uvs.size())][roll.below(3)];
      double& x = roll() < 0.5 ? p.x : p.y;
      const double kind = roll();
      x = kind < 0.3 ? odd[roll.below(std::size(odd))] : kind < 0.6 ? roll() : x + roll(-1e-3, 1e-3);
    }
    const auto r = atlas_from_uvs(mesh, round % 3 == 0 ? 24 : 128);
    (r ? taken : refused) += 1;
    if (r) {
      EXPECT_TRUE(std::isfinite(r->texel_m) && r->narrow_m > 0.0 && r->wide_m < 1.0);
    } else {
      EXPECT_NE(r.error().message.find("texture"), std::string::npos) << r.error().message;
    }
  }
  EXPECT_GT(taken, 20U);
  EXPECT_GT(refused, 100U);
}

}  // namespace
}  // namespace asperity::bake
