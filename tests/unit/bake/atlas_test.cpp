#include "bake/atlas.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "bake/geometry.hpp"
#include "bake/triangle_bvh.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

constexpr std::uint32_t side = 512;

double distance_to(const std::array<vec2, 3>& t, const vec2& p) {
  std::array<vec3, 3> c;
  for (std::size_t k = 0; k < 3; ++k) c[k] = vec3(t[k], 0.0);
  return glm::length(vec3(p, 0.0) - closest_on_triangle(vec3(p, 0.0), c));
}

class AtlasOfShapes : public ::testing::TestWithParam<const char*> {
 protected:
  triangle_mesh mesh() const {
    return std::string(GetParam()) == "box" ? shapes::box({0.04, 0.04, 0.01}, {1, 1, 1})
                                            : shapes::wavy_torus{}.mesh(20, 14);
  }
};

TEST_P(AtlasOfShapes, ChartsAreIsometries) {
  const triangle_mesh coarse = mesh();
  const auto r = make_atlas(coarse, side);
  ASSERT_TRUE(r.has_value()) << r.error().message;
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
    const auto c = corners(coarse.positions, coarse.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const double in_image = glm::length(r->uv[t][(k + 1) % 3] - r->uv[t][k]) * side * r->texel_m;
      EXPECT_NEAR(in_image, glm::length(c[(k + 1) % 3] - c[k]), 1e-3 * r->texel_m);
    }
    for (const vec2& uv : r->uv[t])
      for (const double x : {uv.x, uv.y}) {
        EXPECT_GE(x, 0.0);
        EXPECT_LE(x, 1.0);
        EXPECT_EQ(x, to_float32(x));
      }
  }
}

TEST_P(AtlasOfShapes, EveryTexelBelongsToOneChartAtMost) {
  const triangle_mesh coarse = mesh();
  const auto r = make_atlas(coarse, side);
  ASSERT_TRUE(r.has_value());
  std::size_t covered = 0;
  std::vector<std::uint32_t> owner(std::size_t{side} * side, no_halfedge);
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
    std::array<vec2, 3> c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = static_cast<double>(side) * r->uv[t][k];
    const vec2 low = glm::min(glm::min(c[0], c[1]), c[2]) - gutter_texels;
    const vec2 high = glm::max(glm::max(c[0], c[1]), c[2]) + gutter_texels;
    EXPECT_GE(std::min(low.x, low.y), -1e-3);
    EXPECT_LE(std::max(high.x, high.y), side + 1e-3);
    for (auto j = static_cast<std::uint32_t>(std::max(0.0, low.y)); j < side && j <= high.y; ++j)
      for (auto i = static_cast<std::uint32_t>(std::max(0.0, low.x)); i < side && i <= high.x; ++i) {
        if (distance_to(c, {i + 0.5, j + 0.5}) > gutter_texels - 1e-3) continue;
        std::uint32_t& o = owner[std::size_t{j} * side + i];
        covered += o == no_halfedge;
        if (o == no_halfedge) o = r->chart[t];
        EXPECT_EQ(o, r->chart[t]) << "texel " << i << ", " << j;
      }
  }
  EXPECT_GT(r->utilisation, 0.35);
  EXPECT_LT(r->utilisation * side * side, static_cast<double>(covered));
}

INSTANTIATE_TEST_SUITE_P(Shapes, AtlasOfShapes, ::testing::Values("box", "torus"));

TEST(Atlas, PairsTriangles) {
  const auto r = make_atlas(shapes::box({0.04, 0.03, 0.01}, {1, 1, 1}), side);
  EXPECT_EQ(r->charts, 6u);  // the diagonals of the six faces are their longest edges
}

TEST(Atlas, RefusesATextureThatIsTooSmall) {
  const auto r = make_atlas(shapes::wavy_torus{}.mesh(40, 20), 64);
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, error_code::invalid_argument);
  EXPECT_NE(r.error().message.find("larger texture"), std::string::npos);
}

TEST(Atlas, PacksNeedles) {
  const auto r = make_atlas(shapes::box({0.2, 0.002, 0.002}, {1, 1, 1}), side);
  ASSERT_TRUE(r.has_value()) << r.error().message;
  EXPECT_GT(r->texel_m, 0.2 / side);
}

}  // namespace
}  // namespace asperity::bake
