#include "bake/project.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

constexpr std::uint32_t atlas_side = 256;

struct projected {
  triangle_mesh coarse;
  atlas charts;
  projection out;

  [[nodiscard]] vec2 uv(std::size_t t, const std::array<double, 3>& b) const {
    return b[0] * charts.uv[t][0] + b[1] * charts.uv[t][1] + b[2] * charts.uv[t][2];
  }
  [[nodiscard]] vec3 point(std::size_t t, const std::array<double, 3>& b) const {
    const auto c = corners(coarse.positions, coarse.triangles[t]);
    return b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
  }
};

projected run(const triangle_mesh& coarse, const triangle_mesh& full, double range_m, unsigned threads = 2) {
  const triangle_bvh tree(full.positions, full.triangles);
  const atlas charts = *make_atlas(coarse, atlas_side);
  const crease_normals directions(coarse, tree, 0.5 * charts.texel_m);
  stage_monitor monitor;
  return {coarse, charts, *project(coarse, charts, directions, tree, range_m, atlas_side, threads, monitor)};
}

TEST(CreaseNormals, FlatFacesKeepTheirDirectionWhereTheOriginalHasTheSameEdges) {
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {1, 1, 1});
  const triangle_bvh tree(box.positions, box.triangles);
  const crease_normals directions(box, tree, 1e-4);
  EXPECT_EQ(directions.sharp_edges(), 12u);
  for (std::uint32_t t = 0; t < box.triangles.size(); ++t) {
    const vec3 face = unit_normal(corners(box.positions, box.triangles[t]));
    EXPECT_NEAR(glm::dot(directions.at(t, {0.3, 0.3, 0.4}), face), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(directions.at(t, {0.02, 0.49, 0.49}), face), 1.0, 1e-12);
    EXPECT_LT(glm::dot(directions.at(t, {1.0, 0.0, 0.0}), face), 0.9);  // a corner belongs to three faces
  }
}

TEST(CreaseNormals, AreContinuousAcrossEveryEdge) {
  // A box whose original is rounded off: wide bands, with sharp edges and diagonals.
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {1, 1, 1});
  const triangle_mesh full = shapes::scaled(shapes::box({0.04, 0.03, 0.02}, {8, 8, 8}), 0.95);
  const triangle_bvh tree(full.positions, full.triangles);
  const crease_normals directions(box, tree, 1e-4);
  const connectivity net = connect(box.triangles, box.positions.size());
  for (std::uint32_t h = 0; h < net.mate.size(); ++h)
    for (int i = 0; i <= 50; ++i) {
      const double s = i / 50.0;
      std::array<double, 3> here{};
      std::array<double, 3> there{};
      here[h % 3] = 1.0 - s;
      here[next_halfedge(h) % 3] = s;
      there[next_halfedge(net.mate[h]) % 3] = 1.0 - s;
      there[net.mate[h] % 3] = s;
      const vec3 difference = directions.at(h / 3, here) - directions.at(net.mate[h] / 3, there);
      EXPECT_LT(glm::length(difference), 1e-9) << "edge " << h << " at " << s;
    }
}

TEST(Project, AFlatSurfaceIsReproducedUpToTheEdgesOfItsCharts) {
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {1, 1, 1});
  const projected p = run(box, shapes::box({0.04, 0.03, 0.02}, {5, 5, 5}), 0.005);
  EXPECT_EQ(p.out.fallback_texels, 0u);
  EXPECT_LT(p.out.max_displacement_m, 1e-8);
  shapes::dice roll(3);
  double worst = 0.0;
  for (std::size_t t = 0; t < box.triangles.size(); ++t)
    for (int i = 0; i < 400; ++i) {
      auto b = roll.barycentric();
      if (i < 3) b = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
      worst = std::max(worst, glm::length(p.out.texture.sample(p.uv(t, b)) - p.point(t, b)));
    }
  EXPECT_LT(worst, 1e-3 * p.charts.texel_m);  // float32 texture coordinates
}

TEST(Project, ASlopeGoesOnAcrossTheEdgesBetweenCharts) {
  // The top of the original is tilted against the coarse top; away from the rim both charts at an edge have to say so.
  const vec3 size{0.04, 0.04, 0.02};
  const auto tilt = [](vec3 p) { return p.z > 0.0099 ? p + vec3(0.0, 0.0, 0.05 * p.x) : p; };
  const triangle_mesh coarse = shapes::box(size, {8, 8, 1});
  const projected p = run(coarse, shapes::box(size, {8, 8, 1}, tilt), 0.005);
  std::size_t edges = 0;
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      for (const double s : {0.1, 0.35, 0.5, 0.8}) {
        std::array<double, 3> b{};
        b[k] = 1.0 - s;
        b[(k + 1) % 3] = s;
        const vec3 at = p.point(t, b);
        if (at.z < 0.0099 || std::abs(at.x) > 0.011 || std::abs(at.y) > 0.011) continue;
        EXPECT_LT(glm::length(p.out.texture.sample(p.uv(t, b)) - tilt(at)), 1e-3 * 0.05 * p.charts.texel_m);
        ++edges;
      }
  EXPECT_GT(edges, 100u);
}

TEST(Project, TexelsOutsideChartsAndGuttersHoldNoPosition) {
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {1, 1, 1});
  const projected p = run(box, box, 0.005);
  std::size_t empty = 0;
  for (const glm::vec3& texel : p.out.texture.texels) empty += std::isnan(texel.x);
  EXPECT_GT(empty, 0u);
  EXPECT_GT(p.out.texels, 0u);
  EXPECT_LT(p.out.texels + empty, p.out.texture.texels.size());  // the gutters are the rest
  EXPECT_NEAR(static_cast<double>(p.out.texels) / (atlas_side * atlas_side), p.charts.utilisation, 0.02);
}

TEST(Project, MeasuresDisplacementAlongTheNormal) {
  // The top of the original is 1 mm higher, the rest is the same.
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {1, 1, 1});
  const triangle_mesh full =
      shapes::box({0.04, 0.03, 0.02}, {4, 4, 4}, [](vec3 p) { return p.z > 0.0099 ? p + vec3(0, 0, 0.001) : p; });
  const projected p = run(box, full, 0.01);
  EXPECT_NEAR(p.out.highest_m, 0.001, 1e-6);
  EXPECT_NEAR(p.out.max_displacement_m, p.out.highest_m, 1e-9);
  EXPECT_GT(p.out.lowest_m, -0.0005);
  double top = 0.0;
  std::size_t middle = 0;
  for (std::size_t t = 0; t < box.triangles.size(); ++t)
    if (unit_normal(corners(box.positions, box.triangles[t])).z > 0.5) {
      const vec3 q = p.out.texture.sample(p.uv(t, {0.4, 0.3, 0.3})) - p.point(t, {0.4, 0.3, 0.3});
      top += q.z;
      EXPECT_LT(std::hypot(q.x, q.y), 1e-6);  // straight up, although the corners lean outwards
      ++middle;
    }
  EXPECT_NEAR(top / static_cast<double>(middle), 0.001, 1e-7);
}

TEST(Project, FallsBackToTheClosestPointAndCountsIt) {
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {1, 1, 1});
  const projected p = run(box, shapes::scaled(box, 1.2), 1e-4);
  EXPECT_EQ(p.out.fallback_texels, p.out.texels);
  const projected q = run(box, shapes::scaled(box, 1.2), 0.02);
  EXPECT_LT(q.out.fallback_texels, q.out.texels / 10);
}

}  // namespace
}  // namespace asperity::bake
