// Parts that are thinner than the texture can show are found, and nothing else is.
#include "bake/thin_features.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "shapes.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

void add_box(triangle_mesh& mesh, const vec3& low, const vec3& high) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                (i & 4) != 0 ? high.z : low.z);
  constexpr std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({first + q[0], first + q[1], first + q[2]});
    mesh.triangles.push_back({first + q[0], first + q[2], first + q[3]});
  }
}

thin_features look(const triangle_mesh& mesh, double thinner_than_m, unsigned threads = 2) {
  const triangle_bvh tree(mesh.positions, mesh.triangles, threads);
  stage_monitor monitor;
  return find_thin_features(mesh, tree, thinner_than_m, threads, monitor).value();
}

constexpr double side_m = 0.02;
constexpr double texel_m = 1e-4;

TEST(ThinFeatures, APlateIsOneAndToldWithItsThickness) {
  shapes::dice d(test_support::fresh_seed("ThinFeatures.plate", "30 plates"));
  for (int k = 0; k < 30; ++k) {
    const double t = 0.02 * texel_m * std::pow(400.0, d());
    triangle_mesh mesh;
    add_box(mesh, {0, 0, 0}, {side_m, side_m, t});
    const thin_features found = look(mesh, 2.0 * texel_m);
    if (t < 2.0 * texel_m) {
      EXPECT_GT(found.share, 0.9) << t;
      EXPECT_NEAR(found.thinnest_m, t, 1e-6 * t);
    } else {
      EXPECT_EQ(found.points, 0U) << t;
      EXPECT_TRUE(thin_remark(found, 2.0 * texel_m).empty());
    }
  }
}

TEST(ThinFeatures, NeitherAnEdgeNorAGapOfAirIsOne) {
  triangle_mesh two;
  add_box(two, {0, 0, 0}, {side_m, side_m, side_m});
  EXPECT_EQ(look(two, 2.0 * texel_m).points, 0U);
  add_box(two, {0, 0, side_m + 0.3 * texel_m}, {side_m, side_m, 2.0 * side_m});
  EXPECT_EQ(look(two, 2.0 * texel_m).points, 0U) << "the gap between two cubes";
  // A wedge of 45 degrees: as thin as one likes at its edge, but its walls stand across each other.
  triangle_mesh wedge;
  wedge.positions = {{0, 0, 0},      {side_m, 0, 0},      {side_m, 0, side_m},
                     {0, side_m, 0}, {side_m, side_m, 0}, {side_m, side_m, side_m}};
  wedge.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {0, 2, 5}, {0, 5, 3}};
  EXPECT_EQ(look(wedge, 2.0 * texel_m).points, 0U);
}

TEST(ThinFeatures, TheirPlaceIsOnThem) {
  shapes::dice d(test_support::fresh_seed("ThinFeatures.place", "20 fins"));
  for (int k = 0; k < 20; ++k) {
    const double t = d(0.1, 1.9) * texel_m, x = d(0.1, 0.9) * side_m;
    triangle_mesh mesh;
    add_box(mesh, {0, 0, 0}, {side_m, side_m, side_m});
    add_box(mesh, {x, 0.3 * side_m, 1.1 * side_m}, {x + t, 0.7 * side_m, 1.2 * side_m});
    const thin_features found = look(mesh, 2.0 * texel_m), alone = look(mesh, 2.0 * texel_m, 1);
    ASSERT_GT(found.points, 0U);
    EXPECT_GE(found.at.z, 1.1 * side_m);
    EXPECT_NEAR(found.at.x, x, t + 1e-9);
    EXPECT_EQ(found.points, alone.points) << "the number of threads";
    EXPECT_EQ(found.at, alone.at);
    const double fin = 2.0 * 0.4 * 0.1, whole = 6.0 + fin + 2.0 * (0.4 + 0.1) * t / side_m;
    EXPECT_NEAR(found.share, fin / whole, 0.1 * fin / whole);
    const std::string told = thin_remark(found, 2.0 * texel_m);
    EXPECT_NE(told.find("thinner than two texels (0.2 mm)"), std::string::npos) << told;
  }
}

}  // namespace
}  // namespace asperity::bake
