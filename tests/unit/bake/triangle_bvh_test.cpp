#include "bake/triangle_bvh.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "bake/geometry.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

TEST(TriangleBvh, ClosestPointAgreesWithLookingAtEveryTriangle) {
  const triangle_mesh mesh = shapes::wavy_torus{}.mesh(60, 30);
  const triangle_bvh tree(mesh.positions, mesh.triangles);
  shapes::dice roll(1);
  for (int i = 0; i < 500; ++i) {
    const vec3 p{roll(-0.1, 0.1), roll(-0.1, 0.1), roll(-0.05, 0.05)};
    double best = std::numeric_limits<double>::infinity();
    for (const index_triangle& t : mesh.triangles)
      best = std::min(best, glm::length(p - closest_on_triangle(p, corners(mesh.positions, t))));
    const auto found = tree.closest(p);
    EXPECT_DOUBLE_EQ(found.distance_m, best);
    EXPECT_NEAR(glm::length(found.point - p), best, 1e-15);
    EXPECT_EQ(tree.closest(p, 0.99 * best).triangle, no_halfedge);
  }
}

TEST(TriangleBvh, IsTheSameTreeWithAnyNumberOfThreads) {
  // Counts at and about those where leaves are full: the halves find their places by counting.
  for (const std::uint32_t around : {64U, 100U, 128U, 129U}) {
    const triangle_mesh mesh = shapes::wavy_torus{}.mesh(around, 64);
    const triangle_bvh one(mesh.positions, mesh.triangles, 1);
    shapes::dice roll(2);
    std::vector<vec3> points;
    for (int i = 0; i < 100; ++i) points.emplace_back(roll(-0.1, 0.1), roll(-0.1, 0.1), roll(-0.05, 0.05));
    for (const unsigned threads : {2U, 3U, 7U}) {
      const triangle_bvh many(mesh.positions, mesh.triangles, threads);
      for (const vec3& p : points) {
        const auto a = one.closest(p);
        const auto b = many.closest(p);
        EXPECT_EQ(a.triangle, b.triangle);
        EXPECT_EQ(a.point, b.point);
      }
      // Every triangle once, and in the same order.
      std::vector<std::uint32_t> in_one, in_many;
      one.visit_box(vec3(-1.0), vec3(1.0), [&](std::uint32_t t) { in_one.push_back(t); });
      many.visit_box(vec3(-1.0), vec3(1.0), [&](std::uint32_t t) { in_many.push_back(t); });
      EXPECT_EQ(in_one.size(), mesh.triangles.size());
      EXPECT_EQ(in_one, in_many);
    }
  }
}

TEST(TriangleBvh, ClosestPointOnATriangleInEveryRegion) {
  const std::array<vec3, 3> c{vec3(0, 0, 0), vec3(2, 0, 0), vec3(0, 2, 0)};
  const auto near = [](const vec3& a, const vec3& b) { return glm::length(a - b) < 1e-15; };
  EXPECT_TRUE(near(closest_on_triangle({0.5, 0.5, 3}, c), {0.5, 0.5, 0}));
  EXPECT_TRUE(near(closest_on_triangle({1, -1, 1}, c), {1, 0, 0}));
  EXPECT_TRUE(near(closest_on_triangle({2, 2, 1}, c), {1, 1, 0}));
  EXPECT_TRUE(near(closest_on_triangle({-1, -1, 0}, c), {0, 0, 0}));
  EXPECT_TRUE(near(closest_on_triangle({5, -1, 0}, c), {2, 0, 0}));
  const std::array<vec3, 3> needle{vec3(0, 0, 0), vec3(1, 0, 0), vec3(2, 0, 0)};
  EXPECT_TRUE(near(closest_on_triangle({1.5, 1, 0}, needle), {1.5, 0, 0}));
}

TEST(TriangleBvh, CrossingTakesTheNearestFrontInEitherDirection) {
  // Two nested boxes: along +x from between the walls lie the inner front (behind) and the outer one (ahead).
  const triangle_mesh mesh =
      shapes::both(shapes::box({0.1, 0.1, 0.1}, {3, 3, 3}), shapes::box({0.2, 0.2, 0.2}, {3, 3, 3}));
  const triangle_bvh tree(mesh.positions, mesh.triangles);
  const vec3 x{1, 0, 0};
  const auto inner = tree.nearest_front_crossing({0.06, 0.001, 0.002}, x, 0.1);
  ASSERT_TRUE(inner);
  EXPECT_NEAR(inner->offset_m, -0.01, 1e-12);
  const auto outer = tree.nearest_front_crossing({0.09, 0.001, 0.002}, x, 0.1);
  ASSERT_TRUE(outer);
  EXPECT_NEAR(outer->offset_m, 0.01, 1e-12);
  EXPECT_FALSE(tree.nearest_front_crossing({0.07, 0.001, 0.002}, x, 0.01));
  // The faces at -x look the other way and do not count.
  EXPECT_NEAR(tree.nearest_front_crossing({-0.0501, 0.001, 0.002}, x, 1.0)->offset_m, 0.1001, 1e-12);
}

TEST(TriangleBvh, NoLineSlipsThroughAnEdgeOrCorner) {
  const triangle_mesh mesh = shapes::box({0.1, 0.1, 0.1}, {7, 7, 7});
  const triangle_bvh tree(mesh.positions, mesh.triangles);
  for (int i = 0; i <= 7; ++i)
    for (int j = 0; j <= 7; ++j) {
      const vec3 p{0.1 * (i / 7.0 - 0.5), 0.1 * (j / 7.0 - 0.5), 0.0};
      EXPECT_TRUE(tree.nearest_front_crossing(p, {0, 0, 1}, 0.2)) << i << " " << j;
    }
}

}  // namespace
}  // namespace asperity::bake
