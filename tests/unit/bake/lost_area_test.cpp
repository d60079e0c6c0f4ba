// Surface that no texel holds, against bodies whose hidden area is known.
#include "bake/lost_area.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "asperity/bake/bake.hpp"
#include "bake/geometry.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

constexpr double mm = 1e-3;

// A slab with a chamber under its top, open through a slit: the coarse slab's top looks through the slit only.
//
//   ______         ______   z = 5 mm
//   |    ___     ___    |   4 mm     slit 6 x 6 mm, chamber 20 x 20 mm
//   |   |___________|   |   1.5 mm
//   |___________________|  -5 mm
constexpr double slit = 6 * mm;
constexpr double chamber = 20 * mm;
constexpr double height = 2.5 * mm;

triangle_mesh chambered_slab() {
  const std::vector<double> plane{-30 * mm, -0.5 * chamber, -0.5 * slit, 0.5 * slit, 0.5 * chamber, 30 * mm};
  return shapes::cells({plane, plane, std::vector<double>{-5 * mm, 1.5 * mm, 4 * mm, 5 * mm}},
                       [](const std::array<int, 3>& c) {
                         const bool in_chamber = c[2] == 1 && c[0] >= 1 && c[0] <= 3 && c[1] >= 1 && c[1] <= 3;
                         const bool in_slit = c[2] == 2 && c[0] == 2 && c[1] == 2;
                         return !in_chamber && !in_slit;
                       });
}

const textured_model& baked_slab() {
  static const textured_model model = [] {
    bake_settings options;
    options.texture_size = 512;
    options.threads = 2;
    options.coarse = shapes::box({60 * mm, 60 * mm, 10 * mm}, {1, 1, 1});
    return *bake(chambered_slab(), options);
  }();
  return model;
}

TEST(LostArea, IsTheHiddenPartOfAnUndercut) {
  const textured_model& model = baked_slab();
  const bake_quality& q = *model.report.quality;
  // Hidden: the chamber's ceiling, its walls, and its floor beside the slit. The floor goes on counting as seen for two
  // texels beyond what is seen through the slit.
  const double reach = 2.0 * q.texel_m;
  const double whole = 2.0 * 60 * 60 * mm * mm + 4.0 * 60 * 10 * mm * mm + 4.0 * slit * mm +
                       2.0 * (chamber * chamber - slit * slit) + 4.0 * chamber * height;
  const double ceiling = chamber * chamber - slit * slit;
  const double seen_floor = slit * slit + 4.0 * slit * reach + std::numbers::pi * reach * reach;
  const double hidden = ceiling + 4.0 * chamber * height + chamber * chamber - seen_floor;
  EXPECT_NEAR(q.lost_share / (hidden / whole), 1.0, 0.02);
  // Ceiling, walls and floor hang together.
  EXPECT_NEAR(q.lost_part_share, q.lost_share, 1e-12);
  EXPECT_LT(std::hypot(q.lost_part_centre.x, q.lost_part_centre.y), 0.1 * mm);
  EXPECT_GT(q.lost_part_centre.z, 2.0 * mm);
  EXPECT_LT(q.lost_part_centre.z, 3.5 * mm);
  EXPECT_NEAR(q.lost_part_low.x, -0.5 * chamber, 1e-6);
  EXPECT_NEAR(q.lost_part_high.y, 0.5 * chamber, 1e-6);
  EXPECT_NEAR(q.lost_part_low.z, 1.5 * mm, 1e-6);
  EXPECT_NEAR(q.lost_part_high.z, 4.0 * mm, 1e-6);
}

TEST(LostArea, ShowsInTheLargestErrorsAndNotInTheOthers) {
  const bake_quality& q = *baked_slab().report.quality;
  EXPECT_NEAR(q.to_textured.max_m, 3.5 * mm, 0.05 * mm);  // the chamber's corners, from the top over them
  EXPECT_LT(q.to_original.max_m, 0.51 * height);          // half-way between floor and ceiling, where the texture falls
  EXPECT_LT(q.to_original.p99_m, 0.2 * mm);
  EXPECT_LT(q.to_textured.median_m, 1e-6);
}

TEST(LostArea, OfASurfaceThatIsAllSeenIsNothing) {
  bake_settings options;
  options.texture_size = 256;
  options.threads = 2;
  options.triangles = 300;
  const auto model = bake(shapes::wavy_torus{}.mesh(160, 72), options);
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->report.quality->lost_share, 0.0);
  EXPECT_EQ(model->report.quality->lost_part_share, 0.0);
}

// Both sides of a plate thinner than the reach: a side is not found on the other one, which faces away.
TEST(LostArea, TheOtherSideOfAThinWallDoesNotCount) {
  const triangle_mesh plate = shapes::box({40 * mm, 40 * mm, 0.2 * mm}, {8, 8, 1});
  triangle_mesh top;
  top.positions = plate.positions;
  for (const auto& t : plate.triangles)
    if (unit_normal(corners(plate.positions, t)).z > 0.5) top.triangles.push_back(t);
  const triangle_bvh seen(top.positions, top.triangles);
  const fine_points points = sample_mesh(plate, 1.0 * mm);
  std::vector<double> distance;
  for (const vec3& p : points.mesh.positions) distance.push_back(seen.closest(p).distance_m);
  stage_monitor monitor;
  const auto lost = find_lost(points, distance, seen, 1.0 * mm, 1, monitor);
  const lost_area area = measure_lost(plate, points, lost);
  const double rim = 4.0 * 40 * 0.2;
  EXPECT_NEAR(area.share, (40.0 * 40.0 + rim) / (2.0 * 40.0 * 40.0 + rim), 0.01);
}

TEST(FinePoints, KeepTheAreaAndTheSourceOfEveryTriangle) {
  for (const double thickness : {10 * mm, 0.5 * mm}) {  // the second has slivers
    const triangle_mesh mesh = shapes::box({40 * mm, 30 * mm, thickness}, {1, 1, 1});
    const fine_points points = sample_mesh(mesh, 2 * mm);
    ASSERT_EQ(points.source.size(), points.mesh.triangles.size());
    std::vector<double> area(mesh.triangles.size(), 0.0);
    for (std::size_t i = 0; i < points.source.size(); ++i)
      area[points.source[i]] +=
          0.5 * glm::length(area_normal(corners(points.mesh.positions, points.mesh.triangles[i])));
    for (std::size_t t = 0; t < area.size(); ++t)
      EXPECT_NEAR(area[t], 0.5 * glm::length(area_normal(corners(mesh.positions, mesh.triangles[t]))), 1e-12);
    EXPECT_LT(points.mesh.positions.size(), 3000u);
  }
}

TEST(FinePoints, AreAStepApart) {
  const triangle_mesh mesh = shapes::box({40 * mm, 30 * mm, 10 * mm}, {1, 1, 1});
  const fine_points points = sample_mesh(mesh, 2 * mm);
  shapes::dice roll(3);
  for (const index_triangle& t : mesh.triangles) {
    const auto c = corners(mesh.positions, t);
    for (int i = 0; i < 50; ++i) {
      const auto b = roll.barycentric();
      const vec3 p = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
      double nearest = 1.0;
      for (const vec3& q : points.mesh.positions) nearest = std::min(nearest, glm::length(p - q));
      EXPECT_LT(nearest, 2 * mm);
    }
  }
}

}  // namespace
}  // namespace asperity::bake
