// Which coarse edges can be felt, and which triangles share a cell.
#include "asperity/cells/coarse_regions.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "meshes.hpp"

namespace asperity {
namespace {

using detail::coarse_regions;
using detail::edge_kind;
using test_support::corner_block;
using test_support::cut_model;

constexpr double degree = std::numbers::pi / 180.0;

TEST(CoarseRegions, ABoxHasTwelveEdgesAndSixFaces) {
  const cut_model box(test::box_mesh({0.01, 0.02, 0.03}, 3));
  EXPECT_EQ(box.count(edge_kind::convex), 36);  // three pieces of each
  EXPECT_EQ(box.count(edge_kind::concave), 0);
  ASSERT_EQ(box.regions.members.size(), 6U);
  for (std::size_t r = 0; r < 6; ++r) {
    EXPECT_EQ(box.regions.members[r].size(), 18U);
    for (const std::uint32_t t : box.regions.members[r]) {
      EXPECT_EQ(box.regions.region[t], r);
      EXPECT_LT(glm::distance(box.index.normal[t], box.regions.normal[r]), 1e-12);
    }
  }
}

TEST(CoarseRegions, AnInnerCornerIsConcave) {
  const cut_model block(corner_block(0.01, 0.005));
  EXPECT_EQ(block.count(edge_kind::concave), 1);
  EXPECT_EQ(block.count(edge_kind::convex), 5 + 12);
  EXPECT_EQ(block.regions.members.size(), 8U);
  // Exactly the upright edge at (0, 0).
  for (std::size_t t = 0; t < block.regions.kind.size(); ++t) {
    const auto c = corners(block.model.mesh, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3 middle = 0.5 * (c[k] + c[(k + 1) % 3]);
      const bool at_corner = std::hypot(middle.x, middle.y) < 1e-9 && std::fabs(middle.z) < 1e-9;
      EXPECT_EQ(block.regions.kind[t][k] == edge_kind::concave, at_corner);
    }
  }
}

TEST(CoarseRegions, SharpIsWhatTurnsMoreThanTheSetting) {
  const coarse_mesh rod = test::prism_mesh(test::regular_polygon(12, 0.01), 0.01);  // upright edges turn 30 degrees
  EXPECT_EQ(cut_model(rod).count(edge_kind::convex), 12 + 24);
  cell_settings rounder;
  rounder.sharp_edge_rad = 35.0 * degree;
  EXPECT_EQ(cut_model(rod, rounder).count(edge_kind::convex), 24);
}

TEST(CoarseRegions, ACurvedSurfaceIsCutInCellsOfNearlyOneDirection) {
  const cut_model rod(test::prism_mesh(test::regular_polygon(72, 0.01), 0.01));  // 5 degrees each
  EXPECT_EQ(rod.count(edge_kind::convex), 144);
  const auto& regions = rod.regions;
  std::vector<int> owners(rod.model.mesh.triangles.size(), 0);
  for (std::size_t r = 0; r < regions.members.size(); ++r) {
    const vec3 seed = rod.index.normal[regions.members[r].front()];
    vec3 sum(0.0);
    for (const std::uint32_t t : regions.members[r]) {
      ++owners[t];
      EXPECT_EQ(regions.region[t], r);
      EXPECT_GE(glm::dot(rod.index.normal[t], seed), std::cos(10.01 * degree));
      sum += area_normal(corners(rod.model.mesh, t));
    }
    EXPECT_LT(glm::distance(regions.normal[r], glm::normalize(sum)), 1e-12);
  }
  for (const int n : owners) EXPECT_EQ(n, 1);
  // Two discs, and a mantle of 72 sides in cells of at most five.
  EXPECT_GE(regions.members.size(), 2U + 72U / 5U);
  EXPECT_LE(regions.members.size(), 2U + 36U);

  cell_settings wide;
  wide.cell_angle_rad = 40.0 * degree;
  EXPECT_LT(cut_model(rod.model.mesh, wide).regions.members.size(), regions.members.size());
}

TEST(CoarseRegions, GrowsFromTheLargestTriangle) {
  const cut_model rod(test::prism_mesh({{0.01, 0.0}, {0.0, 0.01}, {-0.013, 0.002}, {-0.001, -0.008}}, 0.004));
  std::size_t longest = 0;
  for (const auto& list : rod.regions.members) {
    longest = std::max(longest, list.size());
    const auto area = [&](std::uint32_t t) { return glm::length(area_normal(corners(rod.model.mesh, t))); };
    for (const std::uint32_t t : list) EXPECT_LE(area(t), area(list.front()));
  }
  EXPECT_GE(longest, 2U);  // a triangle alone is the largest whatever the order
}

TEST(CoarseRegions, AnOpenBorderIsAnEdge) {
  const cut_model sheet(test::triangle_mesh_of({vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)}));
  EXPECT_EQ(sheet.count(edge_kind::convex), 3);
  EXPECT_EQ(sheet.regions.members.size(), 1U);
  EXPECT_TRUE(sheet.regions.is_border(sheet.index, 0, 1));
}

/// A square in two triangles, and along its diagonal a third without area: its corners lie on a line.
coarse_mesh square_with_a_needle(const vec3& turn) {
  const quat rotation = exp_rotation(turn);
  coarse_mesh mesh;
  for (const vec3& p : {vec3(0, 0, 0), vec3(0.01, 0, 0), vec3(0.01, 0.01, 0), vec3(0, 0.01, 0)}) {
    mesh.positions.push_back(rotation * p);
  }
  mesh.positions.push_back(0.5 * mesh.positions[2]);
  for (const std::array<std::uint32_t, 3>& v :
       {std::array{0U, 1U, 2U}, std::array{0U, 2U, 4U}, std::array{0U, 4U, 3U}, std::array{4U, 2U, 3U}}) {
    mesh.triangles.push_back({v, {}});
  }
  return mesh;
}

TEST(CoarseRegions, ATriangleWithoutAreaBelongsToNoRegionAndMakesNoSharpEdge) {
  test::uniform_source random(1);
  for (int n = 0; n < 100; ++n) {  // below or above its neighbour's plane by the last digit: as it falls
    const cut_model square(square_with_a_needle(random.in_box(2.0)));
    ASSERT_EQ(square.index.normal[1], vec3(0.0));
    EXPECT_EQ(square.regions.region[1], coarse_regions::none);
    for (std::size_t t = 0; t < 4; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (square.index.neighbour[t][k] == coarse_regions::none) continue;
        EXPECT_NE(square.regions.kind[t][k], edge_kind::convex) << "triangle " << t << ", edge " << k;
      }
    }
  }
}

TEST(CoarseRegions, APositionThatIsNotANumberIsLeftOut) {
  coarse_mesh mesh = test::box_mesh({0.01, 0.01, 0.01}, 8);
  const std::size_t triangles = mesh.triangles.size();
  mesh.positions[20].x = std::numeric_limits<double>::quiet_NaN();
  const textured_model model = test_support::bare_model(mesh);
  const detail::surface_index index(model);
  const coarse_regions regions(model.mesh, index, {});
  std::size_t in_regions = 0;
  for (const auto& list : regions.members) in_regions += list.size();
  EXPECT_LT(in_regions, triangles);
  for (const vec3& n : regions.normal) EXPECT_NEAR(glm::length(n), 1.0, 1e-12);
}

}  // namespace
}  // namespace asperity
