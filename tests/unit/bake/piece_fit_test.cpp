#include "bake/piece_fit.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "bake/collapse.hpp"
#include "bake/convex_hull.hpp"
#include "bake/geometry.hpp"
#include "bake/pieces.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

// One piece around the whole mesh, whatever its shape.
convex_piece hull_around(const triangle_mesh& mesh) {
  const auto lattice = to_lattice(mesh.positions, bounds_of(mesh.positions));
  convex_hull hull(lattice);
  convex_piece out;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) hull.insert(v);
  out.vertices = mesh.positions;
  out.hull = hull.faces();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) out.triangles.push_back(t);
  return out;
}

TEST(PieceFit, OfAConvexBodyIsNothing) {
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {3, 3, 3});
  stage_monitor monitor;
  const auto fit = measure_fit(box, {hull_around(box)}, 0.001, monitor);
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->surface_to_hull_max_m, 1e-9);
  EXPECT_LT(fit->bridged_air_max_m, 1e-9);
}

TEST(PieceFit, OfAHullOverANotchIsTheNotch) {
  const double width = 0.02;
  const double depth = 0.008;
  const triangle_mesh notched =
      shapes::cells({{{-0.03, -0.5 * width, 0.5 * width, 0.03}, {-0.01, 0.01}, {-0.01, 0.01 - depth, 0.01}}},
                    [](const std::array<int, 3>& c) { return !(c[0] == 1 && c[2] == 1); });
  stage_monitor monitor;
  const auto fit = measure_fit(notched, {hull_around(notched)}, 0.0005, monitor);
  ASSERT_TRUE(fit);
  // The hull's lid is 8 mm above the floor; from its middle the walls are 10 mm away.
  EXPECT_NEAR(fit->surface_to_hull_max_m, depth, 1e-9);
  EXPECT_NEAR(fit->bridged_air_max_m, depth, 1e-4);
}

triangle_mesh coarse_torus(std::size_t triangles) {
  stage_monitor monitor;
  shapes::wavy_torus torus;
  torus.amplitude_m = 0.0;
  return *collapse_edges(torus.mesh(80, 40), triangles, monitor);
}

TEST(PieceFit, OfADecompositionKeepsItsLimits) {
  stage_monitor monitor;
  const triangle_mesh coarse = coarse_torus(300);
  const double diagonal = bounds_of(coarse.positions).diagonal();
  const auto pieces = *decompose(coarse, piece_limits{}, monitor);
  const auto fit = measure_fit(coarse, pieces, 0.002 * diagonal, monitor);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->surface_to_hull_max_m, 0.0);
  EXPECT_LT(fit->surface_to_hull_max_m, 1e-3 * diagonal);
  EXPECT_LT(fit->bridged_air_max_m, 4.2e-3 * diagonal);
}

TEST(Pieces, AreAsManyAsAskedForWithinATenth) {
  stage_monitor monitor;
  const triangle_mesh coarse = coarse_torus(90);
  const std::size_t usual = decompose(coarse, piece_limits{}, monitor)->size();
  for (const std::size_t count : {usual + usual / 4, usual + usual / 2}) {
    const auto pieces = decompose_into(coarse, count, monitor);
    ASSERT_TRUE(pieces);
    EXPECT_NEAR(static_cast<double>(pieces->size()), static_cast<double>(count), 0.1 * static_cast<double>(count));
    std::vector<int> seen(coarse.triangles.size(), 0);
    for (const convex_piece& p : *pieces)
      for (const std::uint32_t t : p.triangles) ++seen[t];
    for (const int n : seen) EXPECT_EQ(n, 1);
  }
}

TEST(Pieces, AreFewerAtTheCostOfTheirFit) {
  stage_monitor monitor;
  const triangle_mesh coarse = shapes::box({0.04, 0.04, 0.02}, {6, 6, 1}, [](vec3 p) {
    const bool ripple = p.z > 0.0 && std::abs(p.x) < 0.019 && std::abs(p.y) < 0.019;
    return ripple ? p - vec3(0.0, 0.0, std::lround(p.x / (0.04 / 6)) % 2 == 0 ? 2e-5 : 0.0) : p;
  });
  const auto usual = decompose(coarse, piece_limits{}, monitor);
  const auto fewer = decompose_into(coarse, 1, monitor);
  ASSERT_TRUE(usual && fewer);
  EXPECT_LT(fewer->size(), usual->size());
  EXPECT_GT(measure_fit(coarse, *fewer, 0.001, monitor)->surface_to_hull_max_m,
            measure_fit(coarse, *usual, 0.001, monitor)->surface_to_hull_max_m);
}

TEST(Pieces, AConvexBodyIsOneHoweverManyAreAskedFor) {
  stage_monitor monitor;
  EXPECT_EQ(decompose_into(shapes::box({0.04, 0.03, 0.02}, {2, 2, 2}), 20, monitor)->size(), 1u);
}

}  // namespace
}  // namespace asperity::bake
