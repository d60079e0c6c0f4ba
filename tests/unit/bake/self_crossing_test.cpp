#include "bake/self_crossing.hpp"

#include <gtest/gtest.h>
#include <string>

#include "shapes.hpp"

namespace asperity::bake {
namespace {

self_crossings crossings(const triangle_mesh& mesh, unsigned threads = 2) {
  stage_monitor monitor(nullptr);
  const triangle_bvh tree(mesh.positions, mesh.triangles);
  const auto found = find_self_crossings(mesh, tree, threads, monitor);
  EXPECT_TRUE(found.has_value());
  return found.value_or(self_crossings{});
}

TEST(SelfCrossing, SoundSurfacesHaveNone) {
  EXPECT_EQ(crossings(shapes::tetrahedron()).pairs, 0U);
  EXPECT_EQ(crossings(shapes::box({0.1, 0.2, 0.3}, {6, 5, 4})).pairs, 0U);
  EXPECT_EQ(crossings(shapes::wavy_torus{}.mesh(100, 40)).pairs, 0U);
}

// Two tetrahedra, one corner of the second through the slanted face x + y + z = 0.1 m of the first: three faces meet in
// that corner, and each of them crosses the slanted one.
TEST(SelfCrossing, CountsThePairsOfAKnownCase) {
  const triangle_mesh one = shapes::tetrahedron(vec3(0.0), 0.1);
  EXPECT_EQ(crossings(shapes::both(one, shapes::tetrahedron(vec3(0.04), 0.1))).pairs, 0U);
  const self_crossings found = crossings(shapes::both(one, shapes::tetrahedron(vec3(0.025), 0.1)));
  EXPECT_EQ(found.pairs, 3U);
  EXPECT_NEAR(glm::length(found.first - vec3(0.1 / 3.0)), 0.0, 1e-12);  // the middle of the slanted face
}

TEST(SelfCrossing, FindsASpikeThroughTheOtherSideOnAnyNumberOfThreads) {
  triangle_mesh mesh = shapes::wavy_torus{}.mesh(100, 40);
  mesh.positions[17] *= -1.3;
  const std::size_t one = crossings(mesh, 1).pairs;
  EXPECT_GT(one, 4U);
  EXPECT_EQ(crossings(mesh, 3).pairs, one);
  EXPECT_EQ(crossings(mesh, 3).first, crossings(mesh, 1).first);
}

// Faces that share a vertex can cross as well.
TEST(SelfCrossing, SeesTrianglesThatShareAVertex) {
  const triangle_mesh mesh{
      {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {1, 0, -1}, {2, 5, 1}, {3, 3, 3}}, {{0, 1, 2}, {0, 3, 4}}, {}};
  EXPECT_EQ(crossings(mesh).pairs, 0U) << "the second passes beside the first";
  triangle_mesh near = mesh;
  near.positions[4] = {0.5, 0.1, 1};
  EXPECT_EQ(crossings(near).pairs, 1U);
}

TEST(SelfCrossing, TouchingInOnePlaneIsNoCrossing) {
  const triangle_mesh box = shapes::box({0.1, 0.1, 0.1}, {2, 2, 2});
  EXPECT_EQ(crossings(shapes::both(box, shapes::scaled(box, 1.0, {0.1, 0.02, 0.03}))).pairs, 0U);
}

}  // namespace
}  // namespace asperity::bake
