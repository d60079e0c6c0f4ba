// No NaN texel where a lookup can go, on all six benchmark models: from the texture coordinates and the texels in the
// file alone, without what the baker says of its atlas.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "asperity/io/textured_model_file.hpp"

namespace {

using namespace asperity;

using triangle_2d = std::array<vec2, 3>;  // texels; the centre of texel (i, j) is (i + 0.5, j + 0.5)

/// True where some point of the triangle is less than `reach` from `centre` along both axes: the separating axes of a
/// triangle and a square.
bool meets_square(const triangle_2d& t, const vec2& centre, double reach) {
  const auto apart = [&](const vec2& axis) {
    const double square = reach * (std::fabs(axis.x) + std::fabs(axis.y));
    const double a = glm::dot(axis, t[0] - centre), b = glm::dot(axis, t[1] - centre),
                 c = glm::dot(axis, t[2] - centre);
    return std::min({a, b, c}) >= square || std::max({a, b, c}) <= -square;
  };
  if (apart({1.0, 0.0}) || apart({0.0, 1.0})) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const vec2 edge = t[(k + 1) % 3] - t[k];
    if (apart({-edge.y, edge.x})) return false;
  }
  return true;
}

double distance_to(const triangle_2d& t, const vec2& p) {
  const auto cross = [](const vec2& a, const vec2& b) { return a.x * b.y - a.y * b.x; };
  double nearest = 1e300;
  int positive = 0, negative = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const vec2 edge = t[(k + 1) % 3] - t[k], way = p - t[k];
    const double along = std::clamp(glm::dot(way, edge) / glm::dot(edge, edge), 0.0, 1.0);
    nearest = std::min(nearest, glm::length(way - along * edge));
    (cross(edge, way) >= 0.0 ? positive : negative) += 1;
  }
  return positive == 3 || negative == 3 ? 0.0 : nearest;
}

struct texel_count {
  std::size_t looked_at = 0, holes = 0;
  void add(const vec3& texel) {
    ++looked_at;
    holes += std::isfinite(texel.x) && std::isfinite(texel.y) && std::isfinite(texel.z) ? 0U : 1U;
  }
};

struct holes {
  texel_count in_charts;   ///< centre inside a coarse triangle
  texel_count in_lookups;  ///< weighs in a bilinear lookup at some point of a coarse triangle
  texel_count in_gutters;  ///< within two texels of a coarse triangle
};

constexpr double gutter_texels = 2.0;

holes holes_of(const textured_model& model) {
  holes out;
  const vec2 size(model.texture.width, model.texture.height);
  for (const coarse_triangle& t : model.mesh.triangles) {
    const triangle_2d c{size * t.uv[0], size * t.uv[1], size * t.uv[2]};
    const vec2 low = glm::floor(glm::min(c[0], glm::min(c[1], c[2])) - gutter_texels);
    const vec2 high = glm::ceil(glm::max(c[0], glm::max(c[1], c[2])) + gutter_texels);
    for (double y = std::max(low.y, 0.0); y < std::min(high.y, size.y); ++y) {
      for (double x = std::max(low.x, 0.0); x < std::min(high.x, size.x); ++x) {
        const vec2 centre(x + 0.5, y + 0.5);
        const vec3 texel = model.texture.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
        const double distance = distance_to(c, centre);
        if (distance < 1e-6) out.in_charts.add(texel);
        if (distance < 1.5 && meets_square(c, centre, 1.0 - 1e-6)) out.in_lookups.add(texel);
        if (distance < gutter_texels - 1e-3) out.in_gutters.add(texel);
      }
    }
  }
  return out;
}

textured_model load(const std::string& name) {
  return io::load_textured_model(std::filesystem::path(ASPERITY_TEST_MODELS_DIR) / (name + ".glb")).value();
}

class texel_holes : public testing::TestWithParam<const char*> {};

TEST_P(texel_holes, are_in_no_chart_lookup_or_gutter) {
  const textured_model model = load(GetParam());
  const holes found = holes_of(model);
  std::printf("  %-8s %4u x %-4u  charts %8zu  lookups %8zu  gutters %8zu texels (of neighbours counted for each)\n",
              GetParam(), model.texture.width, model.texture.height, found.in_charts.looked_at,
              found.in_lookups.looked_at, found.in_gutters.looked_at);
  EXPECT_GT(found.in_charts.looked_at, std::size_t{100'000});
  EXPECT_GT(found.in_lookups.looked_at, found.in_charts.looked_at);
  EXPECT_GT(found.in_gutters.looked_at, found.in_lookups.looked_at);
  EXPECT_EQ(found.in_charts.holes, 0U);
  EXPECT_EQ(found.in_lookups.holes, 0U);
  EXPECT_EQ(found.in_gutters.holes, 0U);
}

INSTANTIATE_TEST_SUITE_P(benchmark, texel_holes,
                         testing::Values("block", "gear", "hammer", "cad_part", "file", "torus"),
                         [](const auto& test) { return std::string(test.param); });

// A hole just outside of a triangle's edge is in its lookups and its gutter; half a texel further out in the gutter
// only.
TEST(texel_holes_count, sees_one_texel_beside_an_edge) {
  textured_model model;
  model.texture.width = model.texture.height = 32;
  model.texture.texels.assign(32 * 32, glm::vec3(0.0F));
  coarse_triangle t;
  t.uv = {vec2(8.2, 8.2) / 32.0, vec2(20.2, 8.2) / 32.0, vec2(8.2, 20.2) / 32.0};
  model.mesh.triangles = {t};
  const auto with_hole = [&](std::size_t i, std::size_t j) {
    textured_model torn = model;
    torn.texture.texels[j * 32 + i] = glm::vec3(std::nanf(""));
    const holes h = holes_of(torn);
    return std::array{h.in_charts.holes, h.in_lookups.holes, h.in_gutters.holes};
  };
  EXPECT_EQ(with_hole(12, 8), (std::array<std::size_t, 3>{1, 1, 1})) << "its centre 0.3 texels inside";
  EXPECT_EQ(with_hole(12, 7), (std::array<std::size_t, 3>{0, 1, 1})) << "0.7 texels outside";
  EXPECT_EQ(with_hole(12, 6), (std::array<std::size_t, 3>{0, 0, 1})) << "1.7 texels outside";
  EXPECT_EQ(with_hole(12, 5), (std::array<std::size_t, 3>{0, 0, 0}));
  EXPECT_EQ(with_hole(7, 7), (std::array<std::size_t, 3>{0, 1, 1})) << "across a corner";
}

}  // namespace
