#include "asperity/bake/wrap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bake/check.hpp"
#include "bake/geometry.hpp"
#include "bake/self_crossing.hpp"
#include "bake/soup_facing.hpp"
#include "bake/wrap_fit.hpp"
#include "bake/wrap_lattice.hpp"
#include "dirty_mesh.hpp"
#include "even_ball.hpp"
#include "shapes.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

using shapes::ball;
using shapes::dice;
using shapes::turned_at_random;
using shapes::without_some;
constexpr double pi = std::numbers::pi;

// The largest distance of drawn points of one mesh from the other, each looked for in all of its triangles.
double drawn_distance(dice& draw, const triangle_mesh& from, const triangle_mesh& to, int points) {
  double largest = 0.0;
  for (int i = 0; i < points; ++i) {
    const auto c = corners(from.positions, from.triangles[draw.below(from.triangles.size())]);
    const auto b = draw.barycentric();
    const vec3 p = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& t : to.triangles)
      nearest = std::min(nearest, glm::length(p - closest_on_triangle(p, corners(to.positions, t))));
    largest = std::max(largest, nearest);
  }
  return largest;
}

struct outcome {
  triangle_mesh mesh;
  wrap_report report;
  long euler = 0;
};

// Wraps, and sees that a bake would take the result as it is: nothing to turn, nothing that crosses.
outcome wrapped(const triangle_mesh& mesh, double cell_m, std::optional<double> thickness_m = {}) {
  outcome out;
  wrap_settings settings;
  settings.cell_m = cell_m;
  settings.thickness_m = thickness_m;
  const auto made = wrap(mesh, settings, out.report);
  EXPECT_TRUE(made) << made.error().message;
  if (!made) return out;
  out.mesh = *made;
  const auto checked = check(*made);
  EXPECT_TRUE(checked) << checked.error().message;
  if (!checked) return out;
  out.euler = checked->euler;
  EXPECT_FALSE(checked->flipped);
  EXPECT_EQ(checked->turned_triangles, 0U);
  EXPECT_EQ(checked->components, out.report.components);
  EXPECT_EQ(made->triangles.size(), out.report.triangles);
  stage_monitor monitor;
  const triangle_bvh tree(made->positions, made->triangles);
  const auto crossing = find_self_crossings(*made, tree, 2, monitor);
  EXPECT_EQ(crossing->pairs, 0U);
  return out;
}

// Every triangle with vertices of its own.
triangle_mesh torn_apart(const triangle_mesh& m) {
  triangle_mesh out;
  for (const auto& t : m.triangles) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    for (const std::uint32_t v : t) out.positions.push_back(m.positions[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

TEST(Wrap, OfASoundMeshLiesOnIt) {
  dice draw(test_support::fresh_seed("Wrap.OfASoundMeshLiesOnIt", "a ball, a torus and a box of drawn sizes"));
  const double size = draw(0.5, 2.0);
  const triangle_mesh torus = shapes::scaled(shapes::wavy_torus{}.mesh(120, 60), size, {0.1, draw(), 0.0});
  const double cell = 0.003 * size;
  const outcome ring = wrapped(torus, cell);
  EXPECT_EQ(ring.report.components, 1U);
  EXPECT_EQ(ring.euler, 0);
  EXPECT_NEAR(dirt::volume(ring.mesh) / dirt::volume(torus), 1.0, 0.01);
  EXPECT_LT(drawn_distance(draw, ring.mesh, torus, 100), 0.3 * cell);
  EXPECT_LT(drawn_distance(draw, torus, ring.mesh, 100), 0.3 * cell);
  EXPECT_LT(ring.report.to_original.max_m, 0.3 * cell);
  EXPECT_EQ(ring.report.plate_share, 0.0);
  EXPECT_EQ(ring.report.made_up_share, 0.0);
  EXPECT_EQ(ring.report.lost_share, 0.0);
  // Half of the surface is within rounding of the original: vertices are on it, and the torus is nearly flat in a cell.
  EXPECT_LT(ring.report.to_original.median_m, 0.02 * cell);

  const vec3 sides{draw(0.05, 0.1), draw(0.05, 0.1), draw(0.05, 0.1)};
  const triangle_mesh box = shapes::box(sides, {1, 1, 1});
  const outcome brick = wrapped(box, 0.003);
  EXPECT_EQ(brick.euler, 2);
  EXPECT_NEAR(dirt::volume(brick.mesh) / dirt::volume(box), 1.0, 0.01);
  EXPECT_LT(drawn_distance(draw, box, brick.mesh, 500), 0.003) << "corners are cut off by less than a cell";
}

// What a repair does not mend: holes, flipped and doubled and loose faces, bodies through each other.
TEST(Wrap, MakesOneBodyOfABrokenBall) {
  dice draw(test_support::fresh_seed("Wrap.MakesOneBodyOfABrokenBall", "5 soups"));
  const double radius = 0.05;
  const triangle_mesh sound = ball(radius, 4);
  const double cell = 0.003;
  std::vector<std::pair<std::string, triangle_mesh>> soups;
  soups.emplace_back("holes", without_some(sound, draw, draw(0.02, 0.08)));
  soups.emplace_back("turned", turned_at_random(sound, draw, draw(0.1, 0.5)));
  soups.emplace_back("doubled", shapes::both(sound, without_some(sound, draw, 0.7)));
  soups.emplace_back("loose", turned_at_random(torn_apart(without_some(sound, draw, 0.03)), draw, draw(0.1, 0.5)));
  triangle_mesh doubled_back = sound;
  for (const auto& t : sound.triangles) doubled_back.triangles.push_back({t[0], t[2], t[1]});
  soups.emplace_back("two-sided", doubled_back);
  for (const auto& [name, soup] : soups) {
    SCOPED_TRACE(name);
    const outcome out = wrapped(soup, cell);
    EXPECT_EQ(out.report.components, 1U);
    EXPECT_EQ(out.euler, 2);
    EXPECT_NEAR(dirt::volume(out.mesh) / dirt::volume(sound), 1.0, 0.02);
    EXPECT_LT(drawn_distance(draw, out.mesh, sound, 80), 0.7 * cell);
    EXPECT_LT(drawn_distance(draw, sound, out.mesh, 80), 0.7 * cell);
  }
}

TEST(Wrap, OfBodiesThroughEachOtherIsTheirOutside) {
  dice draw(test_support::fresh_seed("Wrap.OfBodiesThroughEachOther", "two balls, and one within"));
  const double r = 0.05, apart = draw(0.03, 0.08), cell = 0.004;
  triangle_mesh soup = shapes::both(ball(r, 4), ball(r, 4, {apart, 0.0, 0.0}));
  const outcome both = wrapped(soup, cell);
  const double h = r - 0.5 * apart;
  const double lens = 2.0 * pi * h * h * (3.0 * r - h) / 3.0;
  EXPECT_NEAR(dirt::volume(both.mesh) / (2.0 * 4.0 / 3.0 * pi * r * r * r - lens), 1.0, 0.02);
  EXPECT_EQ(both.report.components, 1U);
  EXPECT_GT(both.report.to_wrap.max_m, 2.0 * cell) << "what lies within is lost, and told";
  EXPECT_GT(both.report.lost_share, 0.05);
  EXPECT_LT(both.report.to_original.max_m, 1.5 * cell);

  soup = shapes::both(soup, shapes::reversed(ball(0.02, 3)));
  soup = shapes::both(soup, ball(0.008, 3));
  const outcome hollow = wrapped(soup, cell);
  EXPECT_EQ(hollow.report.components, 1U);
  EXPECT_NEAR(dirt::volume(hollow.mesh), dirt::volume(both.mesh), 1e-3 * dirt::volume(both.mesh))
      << "a cavity is filled";
}

// An open shell whose inner side is mostly enclosed is filled up to a membrane over its opening.
TEST(Wrap, FillsABowl) {
  triangle_mesh bowl = ball(0.05, 4);
  std::erase_if(bowl.triangles, [&](const auto& t) {
    return bowl.positions[t[0]].z + bowl.positions[t[1]].z + bowl.positions[t[2]].z > 1e-9;
  });
  const outcome out = wrapped(bowl, 0.003);
  EXPECT_EQ(out.euler, 2);
  EXPECT_EQ(out.report.plate_share, 0.0);
  EXPECT_NEAR(dirt::volume(out.mesh) / (2.0 / 3.0 * pi * 0.05 * 0.05 * 0.05), 1.0, 0.05);
  EXPECT_NEAR(out.report.made_up_share, 1.0 / 3.0, 0.05) << "the membrane over the opening";
  EXPECT_LT(out.report.to_wrap.max_m, 0.003);
}

TEST(Wrap, MakesAPlateOfALeaf) {
  dice draw(test_support::fresh_seed("Wrap.MakesAPlateOfALeaf", "a bent sheet"));
  triangle_mesh leaf;
  constexpr std::uint32_t n = 20;
  const double bend = draw(0.0, 4.0);
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double x = 0.1 * i / n, y = 0.06 * j / n;
      leaf.positions.emplace_back(x, y, bend * x * x + 0.002 * std::sin(80.0 * y));
      if (i == n || j == n) continue;
      const std::uint32_t a = i * (n + 1) + j;
      leaf.triangles.push_back({a, a + n + 1, a + n + 2});
      leaf.triangles.push_back({a, a + n + 2, a + 1});
    }
  const double thickness = draw(0.003, 0.005);
  const outcome out = wrapped(leaf, 0.0014, thickness);
  EXPECT_EQ(out.report.components, 1U);
  EXPECT_EQ(out.euler, 2) << "no hole through it";
  EXPECT_EQ(out.report.plate_share, 1.0);
  EXPECT_DOUBLE_EQ(out.report.thickness_m, thickness);
  const double perimeter = 0.32;
  const double expected = thickness * dirt::area(leaf) + 0.125 * pi * thickness * thickness * perimeter;
  EXPECT_NEAR(dirt::volume(out.mesh) / expected, 1.0, 0.08);
  EXPECT_LT(drawn_distance(draw, out.mesh, leaf, 300), 0.5 * thickness + least_cut * 0.0014);
  EXPECT_NEAR(out.report.to_original.median_m, 0.5 * thickness, 0.05 * thickness);
  EXPECT_GT(drawn_distance(draw, leaf, out.mesh, 50), 0.4 * thickness);
}

TEST(Wrap, ThickensAWallThatIsThinnerThanACell) {
  const triangle_mesh wall = shapes::box({0.1, 0.08, 0.0003}, {10, 8, 1});
  const outcome out = wrapped(wall, 0.002);
  EXPECT_EQ(out.report.components, 1U);
  EXPECT_EQ(out.euler, 2);
  EXPECT_GT(out.report.plate_share, 0.95);
  EXPECT_NEAR(dirt::volume(out.mesh) / (0.1 * 0.08 * (out.report.thickness_m + 0.0003)), 1.0, 0.15);
}

TEST(Wrap, DoesNotThickenTheEdgeOfAWedge) {
  triangle_mesh wedge = shapes::box({0.1, 0.05, 0.03}, {1, 1, 1});
  for (vec3& p : wedge.positions)
    if (p.x > 0.0) p.z = 0.1 * p.z;  // 17 degrees between its faces
  const double cell = 0.0025;
  const outcome out = wrapped(wedge, cell);
  EXPECT_EQ(out.report.components, 1U);
  EXPECT_LT(out.report.to_original.max_m, 1.2 * cell);
  EXPECT_NEAR(dirt::volume(out.mesh) / dirt::volume(wedge), 1.0, 0.03);
}

// Two bodies less than a cell apart are joined: where lattice nodes happen to lie in the gap, each would be a tunnel.
TEST(Wrap, FillsAGapNarrowerThanACell) {
  dice draw(test_support::fresh_seed("Wrap.FillsAGapNarrowerThanACell", "two plates, not parallel to the lattice"));
  const double cell = 0.003, turn = draw(0.3, 1.0);
  const double gap = draw(0.3, 1.0) * cell;
  const triangle_mesh half = shapes::box({0.08, 0.06, 0.02}, {4, 3, 1});
  triangle_mesh soup = shapes::both(half, shapes::scaled(half, 1.0, {0.0, 0.0, 0.02 + gap}));
  for (vec3& p : soup.positions)
    p = {std::cos(turn) * p.x - std::sin(turn) * p.z, p.y, std::sin(turn) * p.x + std::cos(turn) * p.z};
  const outcome joined = wrapped(soup, cell);
  EXPECT_EQ(joined.report.components, 1U);
  EXPECT_EQ(joined.euler, 2) << "no tunnel";
  soup = shapes::both(half, shapes::scaled(half, 1.0, {0.0, 0.0, 0.02 + 2.0 * cell}));
  EXPECT_EQ(wrapped(soup, cell).report.components, 2U) << "a gap of two cells stays";
}

TEST(Wrap, KeepsOnlyWhatCanBeTouched) {
  triangle_mesh parts = shapes::both(ball(0.05, 3), shapes::reversed(ball(0.03, 3)));
  parts = shapes::both(parts, ball(0.01, 3));
  parts = shapes::both(parts, ball(0.02, 3, {0.2, 0.0, 0.0}));
  parts = shapes::both(parts, ball(0.001, 2, {0.3, 0.0, 0.0}));
  stage_monitor monitor;
  const auto dropped = keep_outermost(parts, 0.005, 1, monitor);
  ASSERT_TRUE(dropped);
  EXPECT_EQ(dropped->cavities, 2U) << "the hollow, and the ball in it";
  EXPECT_EQ(dropped->specks, 1U);
  EXPECT_EQ(dropped->left, 2U);
  const double expected = dirt::volume(ball(0.05, 3)) + dirt::volume(ball(0.02, 3));
  EXPECT_NEAR(dirt::volume(parts), expected, 1e-9);
}

TEST(Wrap, TurnsPanelsThatFaceAnyWay) {
  dice draw(test_support::fresh_seed("Wrap.TurnsPanelsThatFaceAnyWay", "a ball of 8 panels"));
  triangle_mesh panels;
  for (int octant = 0; octant < 8; ++octant) {
    triangle_mesh part = ball(0.05, 4);
    std::erase_if(part.triangles, [&](const auto& t) {
      const vec3 m = part.positions[t[0]] + part.positions[t[1]] + part.positions[t[2]];
      return ((m.x > 0 ? 1 : 0) | (m.y > 0 ? 2 : 0) | (m.z > 0 ? 4 : 0)) != octant;
    });
    panels = shapes::both(panels, draw() < 0.5 ? shapes::reversed(part) : part);
  }
  const triangle_mesh sound = ball(0.05, 4);
  stage_monitor monitor;
  triangle_mesh turned = panels;
  ASSERT_TRUE(face_outwards(turned, 2, monitor));
  EXPECT_NEAR(dirt::volume(turned), dirt::volume(sound), 1e-9);
  EXPECT_NEAR(dirt::volume(wrapped(panels, 0.003).mesh) / dirt::volume(sound), 1.0, 0.01);
}

TEST(Wrap, ReportsTheDistancesThatAnIndependentMeasurementFinds) {
  dice draw(test_support::fresh_seed("Wrap.ReportsTheDistances", "a ball with a cap cut off"));
  triangle_mesh cut = ball(0.05, 4);
  const double height = draw(0.02, 0.04);
  std::erase_if(cut.triangles, [&](const auto& t) { return cut.positions[t[0]].z > height; });
  const outcome out = wrapped(cut, 0.003);
  const double to_original = drawn_distance(draw, out.mesh, cut, 1000);
  EXPECT_LE(to_original, out.report.to_original.max_m * 1.001);
  EXPECT_GT(to_original, out.report.to_original.max_m * 0.7) << "the middle of the membrane";
  EXPECT_LE(drawn_distance(draw, cut, out.mesh, 150), out.report.to_wrap.max_m * 1.001 + 1e-9);
  std::size_t far = 0;
  constexpr int points = 1500;
  const triangle_bvh tree(cut.positions, cut.triangles);
  std::vector<double> areas{0.0};
  for (const auto& t : out.mesh.triangles)
    areas.push_back(areas.back() + glm::length(area_normal(corners(out.mesh.positions, t))));
  for (int i = 0; i < points; ++i) {
    const auto at = std::upper_bound(areas.begin(), areas.end(), draw(0.0, areas.back())) - areas.begin() - 1;
    const auto c = corners(out.mesh.positions, out.mesh.triangles[static_cast<std::size_t>(at)]);
    const auto b = draw.barycentric();
    far += tree.closest(b[0] * c[0] + b[1] * c[1] + b[2] * c[2]).distance_m > 0.003 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(far) / points, out.report.made_up_share, 0.05);
}

TEST(Wrap, IsTheSameWithAnyNumberOfThreads) {
  dice draw(test_support::fresh_seed("Wrap.IsTheSameWithAnyNumberOfThreads", "one soup"));
  const triangle_mesh soup =
      shapes::both(without_some(torn_apart(ball(0.05, 4)), draw, 0.1), shapes::box({0.15, 0.002, 0.03}, {3, 1, 2}));
  wrap_settings settings;
  settings.cell_m = 0.005;
  wrap_report one, four;
  settings.threads = 1;
  const auto a = wrap(soup, settings, one);
  settings.threads = 4;
  const auto b = wrap(soup, settings, four);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->positions, b->positions);
  EXPECT_EQ(a->triangles, b->triangles);
  EXPECT_EQ(one.to_original, four.to_original);
  EXPECT_EQ(one.to_wrap, four.to_wrap);
  EXPECT_EQ(one.turned_triangles, four.turned_triangles);
}

// Whatever comes in, what comes out is sound or a refusal in words.
TEST(Wrap, HoldsAgainstHostileSoups) {
  dice draw(test_support::fresh_seed("Wrap.HoldsAgainstHostileSoups", "soups of up to 300 triangles"));
  const int soups = test_support::extent(12, 400);
  for (int i = 0; i < soups; ++i) {
    triangle_mesh soup;
    const auto count = static_cast<std::uint32_t>(1 + draw.below(i % 2 == 0 ? 4 : 300));
    const double flat = i % 5 == 0 ? 0.0 : draw();
    for (std::uint32_t t = 0; t < count; ++t) {
      const vec3 at = 0.05 * vec3(draw(-1, 1), draw(-1, 1), flat * draw(-1, 1));
      const double size = std::pow(10.0, draw(-6.0, -1.0));
      for (int k = 0; k < 3; ++k)
        soup.positions.push_back(at + size * vec3(draw(-1, 1), draw(-1, 1), flat * draw(-1, 1)));
      soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
      if (draw() < 0.2) soup.triangles.push_back({3 * t, 3 * t + 2, 3 * t + 1});
      if (draw() < 0.1) soup.triangles.push_back({3 * t, 3 * t, 3 * t + 1});
      if (draw() < 0.1 && t > 0) soup.triangles.push_back({3 * t, 3 * t - 2, 3 * t + 1});
    }
    wrap_settings settings;
    settings.cell_m = bounds_of(soup.positions).diagonal() / draw(10.0, 40.0);
    wrap_report report;
    const auto out = wrap(soup, settings, report);
    if (!out) {
      EXPECT_FALSE(out.error().message.empty());
      continue;
    }
    const auto sound = check(*out);
    EXPECT_TRUE(sound) << i << ": " << sound.error().message;
  }
}

TEST(Wrap, RefusesWhatNothingCanBeMadeOf) {
  const auto refusal = [](const triangle_mesh& mesh, wrap_settings settings = {}) {
    wrap_report report;
    const auto out = wrap(mesh, settings, report);
    EXPECT_FALSE(out);
    return out ? error{} : out.error();
  };
  const triangle_mesh sound = shapes::tetrahedron();
  EXPECT_TRUE(can_wrap(sound));
  EXPECT_EQ(refusal({}).code, error_code::bad_mesh);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    triangle_mesh m = sound;
    m.positions[2].x = bad;
    EXPECT_NE(refusal(m).message.find("vertex 2"), std::string::npos);
    EXPECT_FALSE(can_wrap(m));
  }
  triangle_mesh m = sound;
  m.triangles[1][0] = 9;
  EXPECT_NE(refusal(m).message.find("triangle 1 uses vertex 9 of 4"), std::string::npos);
  EXPECT_FALSE(can_wrap(m));
  for (const double size : {1e30, 1e300, 1e-12}) {
    EXPECT_NE(refusal(shapes::scaled(sound, size)).message.find("metres"), std::string::npos);
    EXPECT_FALSE(can_wrap(shapes::scaled(sound, size)));
  }
  const triangle_mesh line{{{0, 0, 0}, {0.1, 0, 0}, {0.2, 0, 0}}, {{0, 1, 2}}, {}};
  EXPECT_NE(refusal(line).message.find("area"), std::string::npos);
  EXPECT_FALSE(can_wrap(line));
  for (const double cell : {0.0, -1.0, 1e-9, 10.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(refusal(sound, {.cell_m = cell}).code, error_code::invalid_argument);
  const error thin = refusal(sound, {.cell_m = 0.01, .thickness_m = 0.015});
  EXPECT_NE(thin.message.find("cells of 0.0075 m or smaller"), std::string::npos) << thin.message;
}

TEST(Wrap, TakesASingleTriangle) {
  const triangle_mesh one{{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}, {}};
  EXPECT_TRUE(can_wrap(one));
  const outcome out = wrapped(one, 0.002);
  EXPECT_EQ(out.report.plate_share, 1.0);
  EXPECT_EQ(out.euler, 2);
}

TEST(Wrap, CanBeCancelledAnywhere) {
  const triangle_mesh soup = shapes::both(ball(0.05, 3), shapes::box({0.15, 0.0005, 0.03}, {1, 1, 1}));
  std::size_t calls = 0;
  wrap_settings settings;
  settings.cell_m = 0.006;
  settings.threads = 1;
  settings.progress = [&](std::string_view, double) { return ++calls != 0; };
  wrap_report report;
  ASSERT_TRUE(wrap(soup, settings, report));
  const std::size_t all = calls;
  for (std::size_t last = 0; last < all; last += 1 + all / test_support::extent<std::size_t>(10, 100)) {
    calls = 0;
    settings.progress = [&](std::string_view, double) { return ++calls <= last; };
    const auto out = wrap(soup, settings, report);
    ASSERT_FALSE(out) << last;
    EXPECT_EQ(out.error().code, error_code::cancelled);
  }
}

// Of an open ball, whose winding number decides where the membrane spans its opening: faces given twice would move it.
TEST(Wrap, FacesGivenTwiceCountOnce) {
  dice draw(test_support::fresh_seed("Wrap.FacesGivenTwiceCountOnce", "2 balls"));
  for (int run = 0; run < 2; ++run) {
    triangle_mesh open = ball(0.05, 4);
    const double height = draw(0.0, 0.03);
    std::erase_if(open.triangles, [&](const auto& t) { return open.positions[t[0]].z > height; });
    triangle_mesh doubled = open;
    for (const index_triangle& t : open.triangles)
      for (std::size_t copies = draw.below(3); copies > 0; --copies) {
        const std::size_t k = draw.below(3);
        doubled.triangles.push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
      }
    const outcome once = wrapped(open, 0.004), twice = wrapped(doubled, 0.004);
    EXPECT_EQ(twice.report.dropped_triangles, doubled.triangles.size() - open.triangles.size());
    EXPECT_TRUE(twice.mesh.positions == once.mesh.positions);
    EXPECT_TRUE(twice.mesh.triangles == once.mesh.triangles);
  }
}

TEST(Wrap, TurnsClosedPartsThatAreInsideOut) {
  dice draw(test_support::fresh_seed("Wrap.TurnsClosedPartsThatAreInsideOut", "2 pairs of balls"));
  for (int run = 0; run < 2; ++run) {
    const triangle_mesh right = ball(0.05, 3);
    const triangle_mesh other = ball(draw(0.02, 0.04), 3, {draw(0.12, 0.15), draw(-0.02, 0.02), 0.0});
    const outcome made = wrapped(shapes::both(right, shapes::reversed(other)), 0.004);
    EXPECT_EQ(made.report.turned_triangles, other.triangles.size());
    EXPECT_EQ(made.report.plate_share, 0.0) << "taken for a sheet";
    EXPECT_EQ(made.report.components, 2U);
  }
}

}  // namespace
}  // namespace asperity::bake
