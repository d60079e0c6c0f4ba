// Repair of whole meshes: what is clean stays as it is, and what is dirty comes out closed, near to what it was.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

#include "asperity/bake/repair.hpp"
#include "bake/check.hpp"
#include "bake/triangle_bvh.hpp"
#include "dirty_mesh.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

using dirt::kind;

std::vector<triangle_mesh> clean_meshes() {
  const shapes::wavy_torus torus;
  return {dirt::ball(14, 22), torus.mesh(30, 16), shapes::box({0.06, 0.05, 0.07}, {5, 4, 6}),
          shapes::both(dirt::ball(10, 14), shapes::scaled(dirt::ball(8, 12), 0.5, {0.2, 0, 0}))};
}

TEST(Mend, LeavesCleanMeshesByteForByte) {
  std::vector<triangle_mesh> all = clean_meshes();
  all.push_back(
      shapes::both(dirt::ball(10, 14), shapes::reversed(shapes::scaled(dirt::ball(8, 12), 0.5))));  // a cavity
  all.push_back(shapes::reversed(dirt::ball(10, 14)));  // inside-out as a whole: check turns it
  for (const triangle_mesh& clean : all) {
    triangle_mesh m = clean;
    const auto report = repair(m);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->total(), 0U);
    EXPECT_EQ(m.positions, clean.positions);
    EXPECT_EQ(m.triangles, clean.triangles);
  }
}

struct expected {
  kind seeded;
  repair_kind told;
  std::size_t count;
};

// One defect on one mesh: the report tells that one and no other.
TEST(Mend, TellsWhatWasSeeded) {
  const expected all[] = {{kind::cracks, repair_kind::weld, 3},
                          {kind::degenerate_split, repair_kind::degenerate, 1},
                          {kind::same_twice, repair_kind::duplicate, 1},
                          {kind::both_sides, repair_kind::duplicate, 1},
                          {kind::fin, repair_kind::inner_wall, 1},
                          {kind::hole, repair_kind::hole, 1},
                          {kind::inner_ball, repair_kind::inner_component, 1},
                          {kind::inner_wall, repair_kind::inner_wall, 1},
                          {kind::shard, repair_kind::loose_piece, 1}};
  shapes::dice dice(test_support::fresh_seed("mend, one defect", "9 defects"));
  for (const expected& e : all) {
    SCOPED_TRACE(dirt::name(e.seeded));
    triangle_mesh m = dirt::ball(14, 22);
    const double area = dirt::area(m), volume = dirt::volume(m);
    dirt::plant(m, e.seeded, dice);
    const auto report = repair(m);
    ASSERT_TRUE(report) << report.error().message;
    const std::size_t told = (*report)[e.told].count;
    if (e.seeded == kind::inner_wall) {
      EXPECT_TRUE(told == 1 || told == 3) << told;  // the lid or the dent behind it: the smaller goes
    } else {
      EXPECT_EQ(told, e.count);
    }
    EXPECT_EQ(report->total(), told) << "and nothing else";
    EXPECT_EQ(report->triangles_after, m.triangles.size());
    ASSERT_TRUE(check(m));
    EXPECT_NEAR(dirt::area(m), area, 0.01 * area);
    EXPECT_NEAR(dirt::volume(m), volume, 0.01 * volume);
  }
}

TEST(Mend, DirtyMeshesComeOutClosedAndNearToWhatTheyWere) {
  const std::size_t runs = test_support::extent<std::size_t>(600, 20000);
  shapes::dice dice(test_support::fresh_seed("mend, dirty meshes", "600 or 20,000 meshes"));
  const std::vector<triangle_mesh> clean = clean_meshes();
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t which = run % clean.size();
    triangle_mesh m = clean[which];
    std::string planted;
    const std::size_t defects = run % 3 == 0 ? 1 : 1 + dice.below(6);
    for (std::size_t i = 0; i < defects; ++i) {
      const auto k = static_cast<kind>(dice.below(dirt::kinds));
      if (k == kind::inner_ball && which == 1) continue;  // nothing is in the middle of a torus
      planted += std::string(dirt::name(k)) + ", ";
      dirt::plant(m, k, dice);
    }
    SCOPED_TRACE("run " + std::to_string(run) + ", mesh " + std::to_string(which) + ": " + planted);
    triangle_mesh twin = m;
    const auto report = repair(m);
    ASSERT_TRUE(report) << report.error().message;
    const auto checked = check(m);
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_NEAR(dirt::area(checked->mesh), dirt::area(clean[which]), 0.03 * dirt::area(clean[which]));
    EXPECT_NEAR(dirt::volume(checked->mesh), dirt::volume(clean[which]), 0.03 * dirt::volume(clean[which]));
    ASSERT_TRUE(repair(twin));
    EXPECT_EQ(twin.triangles, m.triangles) << "another time it comes out otherwise";
    const auto again = repair(m);
    ASSERT_TRUE(again);
    // What still crosses after four attempts is tried again.
    for (std::size_t k = 0; k < repair_kinds; ++k) {
      if (k == static_cast<std::size_t>(repair_kind::crossing)) continue;
      EXPECT_EQ(again->actions[k].count, 0U) << to_string(static_cast<repair_kind>(k)) << ": what is repaired is clean";
    }
    if (HasFailure() && run > 20) break;
  }
}

// Two walls beside each other share an edge of four, and only the rest of their ball hangs on edges of three alone.
TEST(Mend, WallsSideBySideAreNotTakenForTheBody) {
  const triangle_mesh clean = clean_meshes().back();
  for (const std::size_t first :
       {std::size_t{0}, clean.triangles.size() - 30}) {  // on the large ball, on the small one
    triangle_mesh m = clean;
    const vec3 middle = first == 0 ? vec3(0.0) : vec3(0.2, 0.0, 0.0);
    std::size_t second = first + 1;
    const auto shared = [&] {
      return std::ranges::count_if(m.triangles[second],
                                   [&](auto v) { return std::ranges::count(m.triangles[first], v) > 0; });
    };
    while (shared() != 2) ++second;
    for (const std::size_t of : {first, second}) {
      const auto t = m.triangles[of];
      const vec3 centre = (m.positions[t[0]] + m.positions[t[1]] + m.positions[t[2]]) / 3.0;
      const auto v = static_cast<std::uint32_t>(m.positions.size());
      m.positions.push_back(centre + 0.1 * (middle - centre));
      for (std::size_t k = 0; k < 3; ++k) m.triangles.push_back({t[k], t[(k + 1) % 3], v});
    }
    ASSERT_TRUE(repair(m));
    EXPECT_TRUE(check(m));
    EXPECT_NEAR(dirt::area(m), dirt::area(clean), 0.01 * dirt::area(clean)) << first;
    EXPECT_NEAR(dirt::volume(m), dirt::volume(clean), 0.01 * dirt::volume(clean)) << first;
  }
}

TEST(Mend, OffersOneCommandForWhatIsTooOpen) {
  triangle_mesh bowl = dirt::ball(14, 22);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.positions[t[0]].z > -0.01; });
  const triangle_mesh before = bowl;
  const auto report = repair(bowl);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("; mend it in a mesh editor"), std::string::npos) << report.error().message;
  EXPECT_EQ(bowl.triangles, before.triangles);
}

// A lid whose rim is straight, and a cap whose rim is round.
TEST(Mend, ClosesHolesOfThousandsOfEdges) {
  triangle_mesh open_box = shapes::box({0.1, 0.1, 0.1}, {300, 300, 2});
  std::erase_if(open_box.triangles, [&](const auto& t) {
    return open_box.positions[t[0]].z + open_box.positions[t[1]].z + open_box.positions[t[2]].z > 0.1499;
  });
  triangle_mesh ball = dirt::ball(40, 3000);
  const double whole = dirt::volume(ball);
  std::erase_if(ball.triangles, [&](const auto& t) { return ball.positions[t[0]].z > 0.0455; });
  for (triangle_mesh* m : {&open_box, &ball}) {
    const auto report = repair(*m);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ((*report)[repair_kind::hole].count, 1U);
    EXPECT_TRUE(check(*m));
  }
  EXPECT_NEAR(dirt::volume(open_box), 1e-3, 1e-12);
  EXPECT_NEAR(dirt::volume(ball), whole, 0.02 * whole);
}

// A nose pushed through the opposite side: what crosses is cut out.
TEST(Mend, ResolvesASheetThatPassesThroughItself) {
  triangle_mesh m = dirt::ball(28, 44);
  vec3& tip = m.positions[1 + 13 * 44];
  const vec3 beside = m.positions[1 + 13 * 44 + 2];
  tip = tip + 1.6 * (beside - tip);
  tip *= 0.99;
  const double volume = dirt::volume(m);
  const auto report = repair(m);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT((*report)[repair_kind::crossing].count, 0U);
  EXPECT_LT((*report)[repair_kind::crossing].largest_m, 0.01);
  EXPECT_TRUE(check(m));
  EXPECT_NEAR(dirt::volume(m), volume, 0.01 * volume);
  EXPECT_EQ(repair(m)->total(), 0U);
}

TEST(Mend, TurnsAComponentThatIsInsideOutAndKeepsACavity) {
  triangle_mesh apart =
      shapes::both(dirt::ball(10, 14), shapes::reversed(shapes::scaled(dirt::ball(8, 12), 0.5, {0.2, 0, 0})));
  const auto report = repair(apart);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ((*report)[repair_kind::turned_inside_out].count, 1U);
  EXPECT_TRUE(check(apart));
}

/// Texture coordinates that are linear in space, but for whole numbers: each triangle is a chart of its own.
struct charted {
  mat3 slope{0.0};
  explicit charted(shapes::dice& dice) {
    for (int c = 0; c < 2; ++c)
      for (int k = 0; k < 3; ++k) slope[k][c] = dice(-4.0, 4.0);
  }
  [[nodiscard]] vec2 at(const vec3& p) const {
    const vec3 uv = slope * p;
    return {uv.x, uv.y};
  }
  void lay_on(triangle_mesh& mesh) const {
    mesh.uvs.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        mesh.uvs[t][k] = at(mesh.positions[mesh.triangles[t][k]]) + static_cast<double>(1 + t) * vec2(1.0, 0.0);
  }
  /// The chart of a triangle, where its corners have what was laid there.
  [[nodiscard]] std::optional<std::size_t> chart_of(const triangle_mesh& mesh, std::size_t t) const {
    constexpr double near = 1e-4;
    const double chart = std::round(mesh.uvs[t][0].x - at(mesh.positions[mesh.triangles[t][0]]).x);
    for (std::size_t k = 0; k < 3; ++k)
      if (glm::length(mesh.uvs[t][k] - at(mesh.positions[mesh.triangles[t][k]]) - vec2(chart, 0.0)) > near)
        return std::nullopt;
    return static_cast<std::size_t>(chart) - 1;
  }
};

/// A triangle cut in two at the middle of an edge, which its neighbour knows nothing of.
void plant_t_junction(triangle_mesh& m, shapes::dice& dice) {
  const std::size_t at = dice.below(m.triangles.size());
  const auto t = m.triangles[at];
  const auto v = static_cast<std::uint32_t>(m.positions.size());
  m.positions.push_back(0.5 * (m.positions[t[0]] + m.positions[t[1]]));
  m.triangles[at] = {t[0], v, t[2]};
  m.triangles.push_back({v, t[1], t[2]});
}

/// Cells of a grid of which two touch along an edge: an edge of four triangles.
triangle_mesh touching_cells() {
  const std::vector<double> line{0.0, 0.02, 0.04};
  return shapes::cells({line, line, line}, [](const std::array<int, 3>& c) { return (c[0] + c[1]) % 2 == 0; });
}

TEST(Mend, TextureCoordinatesStayAtTheirCorners) {
  const auto runs = test_support::extent<std::size_t>(400, 10000);
  shapes::dice dice(test_support::fresh_seed("mend, texture coordinates", "400 or 10,000 meshes"));
  std::array<std::size_t, repair_kinds> done{};
  const std::vector<triangle_mesh> clean = clean_meshes();
  for (std::size_t run = 0; run < runs; ++run) {
    triangle_mesh m = run % 5 == 4 ? touching_cells() : clean[run % 5];
    std::string planted;
    for (std::size_t i = dice.below(5) + 1; i > 0; --i) {
      const auto k = static_cast<kind>(dice.below(dirt::kinds));
      if (k == kind::hole || (k == kind::inner_ball && run % 5 != 0)) {
        planted += "T junction, ";
        plant_t_junction(m, dice);
        continue;
      }
      planted += std::string(dirt::name(k)) + ", ";
      dirt::plant(m, k, dice);
    }
    SCOPED_TRACE("run " + std::to_string(run) + ": " + planted);
    const charted charts(dice);
    charts.lay_on(m);
    const std::vector<vec3> before = m.positions;
    const std::vector<index_triangle> had = m.triangles;
    const auto report = repair(m);
    ASSERT_TRUE(report) << report.error().message;
    for (std::size_t k = 0; k < repair_kinds; ++k) done[k] += report->actions[k].count;
    if (report->triangles_added > 0) {
      EXPECT_TRUE(m.uvs.empty()) << "patches have none";
      continue;
    }
    ASSERT_EQ(m.uvs.size(), m.triangles.size());
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const auto chart = charts.chart_of(m, t);
      ASSERT_TRUE(chart) << "triangle " << t;
      ASSERT_LT(*chart, had.size());
      // It lies in the triangle that it was, or was a part of.
      const std::array<vec3, 3> was{before[had[*chart][0]], before[had[*chart][1]], before[had[*chart][2]]};
      for (const std::uint32_t v : m.triangles[t])
        ASSERT_LT(glm::length(closest_on_triangle(m.positions[v], was) - m.positions[v]), 1e-5) << "triangle " << t;
    }
  }
  for (const repair_kind k : {repair_kind::weld, repair_kind::degenerate, repair_kind::t_junction,
                              repair_kind::duplicate, repair_kind::inner_wall, repair_kind::split_edge,
                              repair_kind::turned, repair_kind::loose_piece, repair_kind::inner_component})
    EXPECT_GT(done[static_cast<std::size_t>(k)], 0U) << to_string(k) << " never came up";
}

}  // namespace
}  // namespace asperity::bake
