#include "asperity/bake/repair.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <utility>

#include "dirty_mesh.hpp"

namespace {

using namespace asperity;

// Upright tube of `sides` quads, open at both ends.
triangle_mesh open_tube(std::uint32_t sides) {
  triangle_mesh m;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double a = 2 * std::numbers::pi * i / sides;
    m.positions.emplace_back(std::cos(a), std::sin(a), -1.0);
    m.positions.emplace_back(std::cos(a), std::sin(a), 1.0);
  }
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t j = (i + 1) % sides;
    m.triangles.push_back({2 * i, 2 * j, 2 * j + 1});
    m.triangles.push_back({2 * i, 2 * j + 1, 2 * i + 1});
  }
  return m;
}

bool is_closed_and_oriented(const triangle_mesh& m) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const auto& t : m.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : directed) {
    if (count != 1 || directed.count({edge.second, edge.first}) == 0) return false;
  }
  return true;
}

// As much as there is may be made up: these meshes are all holes.
bake::repair_settings generous() {
  bake::repair_settings out;
  out.largest_made_up_share = 1.0;
  return out;
}

TEST(holes, of_a_tube_are_closed_with_its_lids) {
  triangle_mesh m = open_tube(24);
  const auto report = bake::repair(m, generous());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ((*report)[bake::repair_kind::hole].count, 2U);
  EXPECT_EQ(report->smooth_holes, 0U);
  EXPECT_EQ(report->triangles_added, 2U * (24 - 2));
  EXPECT_TRUE(is_closed_and_oriented(m));
  const double lid = 0.5 * 24 * std::sin(2 * std::numbers::pi / 24);
  EXPECT_NEAR(report->area_added_m2, 2 * lid, 1e-12);
  EXPECT_NEAR(bake::dirt::volume(m), 2 * lid, 1e-12);  // outward, and the lids are flat
  EXPECT_NEAR((*report)[bake::repair_kind::hole].largest_m, 2.0, 1e-12);
}

// A box without its top, and on one side of the rim a triangle that stands up as high as the box is wide. The patch of
// least area is that triangle once more, back to back with itself, and the flat top.
TEST(holes, patch_does_not_fold_onto_what_is_there) {
  triangle_mesh m;
  for (int i = 0; i < 8; ++i) m.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  m.positions.emplace_back(0.5, 0.0, 2.0);
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {1, 3, 7}, {1, 7, 5},
                 {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}, {4, 5, 8}};
  const auto report = bake::repair(m, generous());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ((*report)[bake::repair_kind::hole].count, 1U);
  EXPECT_EQ(report->triangles_added, 3U);
  EXPECT_TRUE(is_closed_and_oriented(m));
  const double flat = 0.5, standing = 0.75, beside = 0.5 * std::sqrt(1.25);  // from a far corner of the rim
  EXPECT_NEAR(report->area_added_m2, flat + standing + beside, 1e-12);
  EXPECT_GT(report->area_added_m2, 1.0 + 0.5) << "the folded patch is smaller";
}

TEST(holes, can_be_followed_once_triangles_against_their_neighbours_are_turned) {
  triangle_mesh tube = open_tube(40);
  for (const std::size_t t : std::array<std::size_t, 3>{3, 4, 31})
    std::swap(tube.triangles[t][1], tube.triangles[t][2]);
  const auto report = bake::repair(tube, generous());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ((*report)[bake::repair_kind::turned].count, 3U);
  EXPECT_EQ((*report)[bake::repair_kind::hole].count, 2U);
  EXPECT_TRUE(is_closed_and_oriented(tube));
}

TEST(holes, of_a_moebius_band_are_refused_and_nothing_changes) {
  triangle_mesh band = open_tube(15);
  for (auto& t : band.triangles) {  // the last column meets the first with top and bottom exchanged
    if (&t < &band.triangles[28]) continue;
    for (auto& v : t) v = v < 2 ? 1 - v : v;
  }
  const triangle_mesh before = band;
  const auto report = bake::repair(band);
  ASSERT_FALSE(report);
  EXPECT_EQ(band.triangles, before.triangles);
  EXPECT_EQ(band.positions, before.positions);
}

}  // namespace
