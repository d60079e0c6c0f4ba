#include "bake/simplify.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "bake/cage.hpp"
#include "bake/collapse.hpp"
#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/relief_fit.hpp"
#include "bake/smooth.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

checked_mesh wavy_torus_mesh() { return *check(shapes::wavy_torus{}.mesh(120, 60)); }

void expect_sound(const triangle_mesh& mesh, long euler) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  EXPECT_TRUE(net.closed_manifold());
  EXPECT_EQ(net.euler, euler);
  EXPECT_TRUE(is_unfolded(mesh));
}

double mean_offset(const triangle_mesh& mesh, const shapes::wavy_torus& smooth, double& worst) {
  shapes::dice roll(7);
  double sum = 0.0;
  double area = 0.0;
  worst = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto c = corners(mesh.positions, t);
    const double weight = glm::length(area_normal(c));
    for (int i = 0; i < 20; ++i) {
      const auto b = roll.barycentric();
      const double offset = smooth.radial_offset(b[0] * c[0] + b[1] * c[1] + b[2] * c[2]);
      sum += weight * offset;
      area += weight;
      worst = std::max(worst, std::abs(offset));
    }
  }
  return sum / area;
}

TEST(Simplify, KeepsTheTopologyAndReachesTheTarget) {
  const checked_mesh full = wavy_torus_mesh();
  stage_monitor monitor;
  const auto coarse = simplify(full, 500, 2, monitor);
  ASSERT_TRUE(coarse.has_value()) << coarse.error().message;
  EXPECT_EQ(coarse->mesh.triangles.size(), 500u);
  EXPECT_EQ(coarse->note, "");
  expect_sound(coarse->mesh, 0);
  for (const vec3& p : coarse->mesh.positions) EXPECT_EQ(p, to_float32(p));
}

// Largest relief that smoothing leaves, as a share of what there was.
double relief_left(const shapes::wavy_torus& wavy, std::uint32_t around, std::uint32_t across) {
  shapes::wavy_torus smooth_one = wavy;
  smooth_one.amplitude_m = 0.0;
  stage_monitor monitor;
  const checked_mesh full = *check(wavy.mesh(around, across));
  double left = 0.0;
  for (const vec3& p : smooth(full.mesh, smoothing_passes(full.mesh.triangles.size(), 300), 2, monitor)) {
    left = std::max(left, std::abs(smooth_one.radial_offset(p)));
  }
  return left / wavy.amplitude_m;
}

TEST(Simplify, SmoothingTakesReliefOffTheFinerTheMore) {
  // Waves of 5.6 mm (40 around, 16 across, at a slant) under coarse edges of 17 mm, then waves of half that.
  shapes::wavy_torus wavy;
  wavy.amplitude_m = 0.001;
  wavy.waves_around = 40;
  wavy.waves_across = 16;
  const double longer = relief_left(wavy, 240, 120);
  EXPECT_LT(longer, 0.45);
  wavy.waves_around = 80;
  wavy.waves_across = 32;
  const double shorter = relief_left(wavy, 480, 240);
  EXPECT_LT(shorter, 0.15);
}

TEST(Simplify, FitCentresTheCoarseMeshInTheRelief) {
  const shapes::wavy_torus wavy;
  shapes::wavy_torus smooth_one = wavy;
  smooth_one.amplitude_m = 0.0;
  const checked_mesh full = wavy_torus_mesh();
  stage_monitor monitor;
  triangle_mesh coarse = simplify(full, 500, 2, monitor)->mesh;
  const std::vector<vec3> normals = vertex_normals(coarse.positions, coarse.triangles);
  for (std::size_t v = 0; v < normals.size(); ++v) coarse.positions[v] -= 0.001 * normals[v];
  double worst_before = 0.0;
  double worst_after = 0.0;
  EXPECT_LT(mean_offset(coarse, smooth_one, worst_before), -0.0008);
  fit_to_relief(coarse, triangle_bvh(full.mesh.positions, full.mesh.triangles), 0.005);
  EXPECT_LT(std::abs(mean_offset(coarse, smooth_one, worst_after)), 5e-5);
  EXPECT_LT(worst_after, 0.6 * worst_before);
  expect_sound(coarse, 0);
}

TEST(Simplify, LeavesASmallMeshAsItIs) {
  const checked_mesh box = *check(shapes::box({0.1, 0.1, 0.1}, {1, 1, 1}));
  stage_monitor monitor;
  EXPECT_EQ(simplify(box, 600, 1, monitor)->mesh.triangles, box.mesh.triangles);
}

TEST(Simplify, KeepsEveryComponentAndEveryHandle) {
  const triangle_mesh torus = shapes::wavy_torus{}.mesh(80, 40);
  const checked_mesh two = *check(shapes::both(torus, shapes::scaled(torus, 0.3, {0.2, 0.0, 0.0})));
  stage_monitor monitor;
  const auto coarse = simplify(two, 300, 1, monitor);
  ASSERT_TRUE(coarse.has_value()) << coarse.error().message;
  const connectivity net = connect(coarse->mesh.triangles, coarse->mesh.positions.size());
  EXPECT_EQ(net.components, 2u);
  EXPECT_EQ(net.euler, 0);
}

TEST(Simplify, SaysSoWhereTheTargetCannotBeReached) {
  // A torus needs 14 triangles at the very least.
  const checked_mesh full = wavy_torus_mesh();
  stage_monitor monitor;
  const auto r = simplify(full, 8, 1, monitor);
  if (r) {
    EXPECT_NE(r->note.find("8 asked for"), std::string::npos);
    expect_sound(r->mesh, 0);
  } else {
    EXPECT_EQ(r.error().code, error_code::bad_mesh);
    EXPECT_NE(r.error().message.find("ask for more triangles"), std::string::npos);
  }
}

TEST(Simplify, CollapseStopsBeforeItPinchesAHandle) {
  const triangle_mesh torus = shapes::wavy_torus{}.mesh(40, 20);
  stage_monitor monitor;
  const auto least = collapse_edges(torus, 4, monitor);
  ASSERT_TRUE(least.has_value());
  EXPECT_GE(least->triangles.size(), 14u);
  const connectivity net = connect(least->triangles, least->positions.size());
  EXPECT_TRUE(net.closed_manifold());
  EXPECT_EQ(net.euler, 0);
}

TEST(Simplify, DoesNotDependOnTheNumberOfThreads) {
  const checked_mesh full = wavy_torus_mesh();
  stage_monitor monitor;
  const auto one = simplify(full, 400, 1, monitor);
  const auto four = simplify(full, 400, 4, monitor);
  EXPECT_EQ(one->mesh.positions, four->mesh.positions);
  EXPECT_EQ(one->mesh.triangles, four->mesh.triangles);
}

TEST(Simplify, SeesAFold) {
  triangle_mesh mesh = shapes::box({0.1, 0.1, 0.1}, {2, 2, 2});
  EXPECT_TRUE(is_unfolded(mesh));
  for (vec3& p : mesh.positions)
    if (p.x == 0.0 && p.y == 0.0 && p.z > 0.0) p.x = 0.12;  // the middle of the top, pulled over the rim
  EXPECT_FALSE(is_unfolded(mesh));
}

TEST(Cage, MeasuresBothWays) {
  const triangle_mesh full = shapes::box({0.1, 0.1, 0.1}, {4, 4, 4});
  const triangle_bvh tree(full.positions, full.triangles);
  stage_monitor monitor;
  EXPECT_NEAR(*measure_cage(full, tree, shapes::box({0.1, 0.1, 0.1}, {1, 1, 1}), 1, monitor), 0.0, 1e-15);
  const auto lower = measure_cage(full, tree, shapes::box({0.1, 0.1, 0.098}, {1, 1, 1}), 1, monitor);
  EXPECT_NEAR(*lower, 0.001, 1e-12);
}

TEST(Cage, RefusesAnotherObjectAndOtherUnits) {
  const triangle_mesh full = shapes::box({0.1, 0.1, 0.1}, {4, 4, 4});
  const triangle_bvh tree(full.positions, full.triangles);
  stage_monitor monitor;
  const auto shifted = measure_cage(full, tree, shapes::scaled(full, 1.0, {0.02, 0.0, 0.0}), 1, monitor);
  ASSERT_FALSE(shifted.has_value());
  EXPECT_NE(shifted.error().message.find("align the two"), std::string::npos);
  const auto units = measure_cage(full, tree, shapes::scaled(full, 1000.0), 1, monitor);
  ASSERT_FALSE(units.has_value());
  EXPECT_NE(units.error().message.find("1000 times larger"), std::string::npos) << units.error().message;
  // A part of the coarse mesh that the original does not have is as wrong as a missing one.
  const auto extra =
      measure_cage(full, tree, shapes::both(full, shapes::scaled(full, 0.1, {0.1, 0.0, 0.0})), 1, monitor);
  EXPECT_FALSE(extra.has_value());
}

}  // namespace
}  // namespace asperity::bake
