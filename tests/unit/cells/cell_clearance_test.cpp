// What surrounds a region, and how far its points are from where the cell ends.
#include "asperity/cells/cell_clearance.hpp"

#include <gtest/gtest.h>
#include <set>

#include "asperity/cells/make_surface_cells.hpp"
#include "asperity/cells/relief_tap.hpp"
#include "meshes.hpp"

namespace asperity {
namespace {

using detail::edge_kind;
using detail::outline_segment;
using test_support::bare_model;
using test_support::corner_block;
using test_support::cut_model;

TEST(OutlineSegment, DistanceIsToTheNearestPointOfIt) {
  const outline_segment s{{0.0, 0.0}, {4.0, 3.0}, edge_kind::convex};
  EXPECT_NEAR(s.distance({2.0, 1.5}), 0.0, 1e-15);
  EXPECT_NEAR(s.distance({2.0 - 0.6, 1.5 + 0.8}), 1.0, 1e-15);
  EXPECT_NEAR(s.distance({-3.0, -4.0}), 5.0, 1e-15);
  EXPECT_NEAR(s.distance({7.0, 7.0}), 5.0, 1e-15);
  const outline_segment point{{1.0, 1.0}, {1.0, 1.0}, edge_kind::convex};
  EXPECT_NEAR(point.distance({4.0, 5.0}), 5.0, 1e-15);
}

/// 3/4 of the integral of |p - s|^-5 by Simpson's rule.
double by_quadrature(const outline_segment& s, const vec2& p) {
  constexpr int n = 4000;
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    const double r = glm::distance(p, glm::mix(s.a, s.b, static_cast<double>(i) / n));
    sum += (i == 0 || i == n ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) / (r * r * r * r * r);
  }
  return 0.75 * sum * glm::distance(s.a, s.b) / (3.0 * n);
}

TEST(OutlineSegment, TheLineIntegralIsTheLineIntegral) {
  test::uniform_source random(1);
  for (const double scale : {1e-3, 1.0, 100.0}) {
    for (int i = 0; i < 200; ++i) {
      const auto point = [&] { return scale * vec2(random(-1, 1), random(-1, 1)); };
      const outline_segment s{point(), point(), edge_kind::convex};
      const vec2 p = point();
      if (s.distance(p) < 0.03 * scale) continue;
      const double expected = by_quadrature(s, p);
      EXPECT_NEAR(s.inverse_distance_4(p), expected, 1e-6 * expected);
    }
  }
}

// A re-entrant corner's edge points straight into its face: nodes lie on its line, millimetres to centimetres off it.
TEST(OutlineSegment, TheLineIntegralHoldsOnTheSegmentsOwnLine) {
  test::uniform_source random(2);
  for (int i = 0; i < 200; ++i) {
    const vec2 from(random(-0.01, 0.01), random(-0.01, 0.01)), along = vec2(random.direction());
    const double length = random(1e-3, 0.05);
    const outline_segment s{from, from + length / glm::length(along) * along, edge_kind::convex};
    for (const double off : {0.0, 1e-12, 1e-9, 1e-7, 1e-5}) {
      const double t = random(1e-3, 0.1);  // beyond either end
      const vec2 u = along / glm::length(along), side(-u.y, u.x);
      for (const vec2& p : {s.b + t * u + off * side, s.a - t * u - off * side}) {
        const double expected = by_quadrature(s, p);
        EXPECT_NEAR(s.inverse_distance_4(p), expected, 1e-4 * expected) << "off the line by " << off;
      }
    }
  }
}

TEST(OutlineSegment, TheLineIntegralOfALongEdgeIsTheDistance) {
  const outline_segment s{{-1.0, 0.0}, {1.0, 0.0}, edge_kind::convex};
  for (const double d : {1e-6, 1e-4, 1e-2}) {
    EXPECT_NEAR(1.0 / std::sqrt(std::sqrt(s.inverse_distance_4({0.1, d}))), d, 1e-6 * d);
  }
  EXPECT_GT(s.inverse_distance_4({0.1, 0.0}), 1e30);  // on the edge: no clearance, and a number
  EXPECT_TRUE(std::isfinite(s.inverse_distance_4({1.0, 0.0})));
  EXPECT_EQ((outline_segment{{1.0, 1.0}, {1.0, 1.0}, edge_kind::convex}.inverse_distance_4({0.0, 0.0})), 0.0);
}

TEST(CellOutline, OfABoxFaceIsItsFourEdges) {
  const cut_model box(test::box_mesh({0.01, 0.01, 0.01}, 4));
  for (std::uint32_t r = 0; r < 6; ++r) {
    const surface_cell cell = detail::place_cell(box.model.mesh, box.index, box.regions, r, box.settings);
    const auto outline = detail::find_outline(cell, r, box.model.mesh, box.index, box.regions, box.settings);
    EXPECT_EQ(outline.own, 32U);
    EXPECT_EQ(outline.shown.size(), 32U);
    EXPECT_EQ(outline.rim.size(), 16U);
    for (const outline_segment& e : outline.rim) {
      EXPECT_EQ(e.kind, edge_kind::convex);
      EXPECT_NEAR(std::max(std::fabs(e.a.x + e.b.x), std::fabs(e.a.y + e.b.y)), 0.02, 1e-12);
    }
  }
}

TEST(CellOutline, ReachesOverSmoothEdgesAsFarAsTheApronAndItsAngle) {
  cell_settings settings;
  settings.apron_m = 2e-3;
  const cut_model rod(test::prism_mesh(test::regular_polygon(72, 0.01), 0.01), settings);
  const double side = 0.02 * std::sin(std::numbers::pi / 72);
  int wider = 0;
  for (std::uint32_t r = 0; r < rod.regions.members.size(); ++r) {
    const vec3 n = rod.regions.normal[r];
    const surface_cell cell = detail::place_cell(rod.model.mesh, rod.index, rod.regions, r, rod.settings);
    const auto outline = detail::find_outline(cell, r, rod.model.mesh, rod.index, rod.regions, rod.settings);
    if (std::fabs(n.z) > 0.5) {  // a disc: its rim is sharp, nothing is shown beyond it
      EXPECT_EQ(outline.shown.size(), outline.own);
      continue;
    }
    EXPECT_EQ(std::set(outline.shown.begin(), outline.shown.end()).size(), outline.shown.size());
    wider += outline.shown.size() > outline.own ? 1 : 0;
    const std::set<std::uint32_t> own(outline.shown.begin(), outline.shown.begin() + std::ptrdiff_t(outline.own));
    const std::set<std::uint32_t> shown(outline.shown.begin(), outline.shown.end());
    // Every triangle of the mantle, by its angle from the region's own ones.
    for (std::uint32_t t = 0; t < rod.model.mesh.triangles.size(); ++t) {
      if (std::fabs(rod.index.normal[t].z) > 0.5) continue;
      double nearest = 10.0;
      for (const std::uint32_t o : own) {
        nearest = std::min(nearest, std::acos(std::min(1.0, glm::dot(rod.index.normal[t], rod.index.normal[o]))));
      }
      const double sides_off = nearest / (2.0 * std::numbers::pi / 72);
      const bool within = sides_off * side<1e-3, beyond = (sides_off - 1.0) * side> 2.2e-3;
      EXPECT_TRUE(!within || shown.count(t) == 1) << "a neighbour within the apron";
      EXPECT_TRUE(!beyond || shown.count(t) == 0) << "beyond the apron";
    }
  }
  EXPECT_GE(wider, 14);
}

/// Clearance of cell `n_b` of a body at a body point.
struct clearance_reader {
  const surface_cells& body;
  const surface_cell* cell = nullptr;

  clearance_reader(const surface_cells& b, const vec3& n_b) : body(b) {
    for (const surface_cell& c : b.cells) {
      if (glm::dot(c.n_b, n_b) > 0.999) cell = &c;
    }
  }
  double operator()(const vec3& p_b) const {
    const detail::relief_map map(body, *cell);
    const vec3 p = cell->to_cell(p_b);
    detail::relief_map::place at{};
    EXPECT_TRUE(map.find(p.x, p.y, at));
    return map.read(at).clearance_m;
  }
};

surface_cells cut(coarse_mesh mesh, double pitch, double depth_limit = 1e-3) {
  cell_settings settings;
  settings.pitch_m = pitch;
  settings.depth_limit_m = depth_limit;
  settings.apron_m = 1.05e-3;
  auto made = make_surface_cells(bare_model(std::move(mesh)), settings);
  EXPECT_TRUE(made);
  return made ? std::move(made).value() : surface_cells{};
}

TEST(Clearance, IsTheDistanceNearAStraightSharpEdge) {
  const surface_cells box = cut(test::box_mesh({0.01, 0.01, 0.01}), 1e-4);
  const clearance_reader at(box, {0, 0, 1});
  ASSERT_NE(at.cell, nullptr);
  for (const double y : {-0.004, 0.0, 0.0051}) {
    for (const double d : {1e-4, 2.3e-4, 5e-4}) {  // farther in, the end of the apron begins to count
      EXPECT_NEAR(at({0.01 - d, y, 0.01}), d, 0.01 * d + 2e-6) << d;
      EXPECT_NEAR(at({y, -0.01 + d, 0.01}), d, 0.01 * d + 2e-6) << d;
    }
    for (const double d : {1e-4, 2.3e-4, 5e-4}) {
      EXPECT_NEAR(at({0.01 + d, y, 0.01}), -d, 0.02 * d + 4e-6) << "beyond the edge by " << d;
    }
  }
}

TEST(Clearance, HasNoKinkWhereTheNearestEdgeChanges) {
  const surface_cells box = cut(test::box_mesh({0.01, 0.01, 0.01}), 1e-4, 5e-3);
  const clearance_reader at(box, {0, 0, 1});
  ASSERT_NE(at.cell, nullptr);
  for (const double d : {1e-3, 2e-3, 4e-3}) {  // from the corner along the diagonal
    const vec3 p(0.01 - d, 0.01 - d, 0.01), across = vec3(-1, 1, 0) / std::sqrt(2.0);
    const double step = 0.1 * d;
    const double soft = at(p + step * across) + at(p - step * across) - 2.0 * at(p);
    const double kink = -std::sqrt(2.0) * step;  // of the distance to the nearest edge
    EXPECT_LT(std::fabs(soft), 0.3 * std::fabs(kink)) << d;
    EXPECT_GT(at(p), 0.75 * d);  // and yet it is a distance
    EXPECT_LE(at(p), d);
  }
}

TEST(Clearance, NothingIsLeftAtTheBorderOfAMapAndNoStepIsSteep) {
  for (const coarse_mesh& mesh :
       {test::box_mesh({0.01, 0.004, 0.007}), corner_block(0.01, 0.005),
        test::prism_mesh(test::regular_polygon(40, 0.01), 0.004), test::torus_mesh(0.01, 0.004, 24, 12)}) {
    const surface_cells body = cut(mesh, 2e-4);
    EXPECT_FALSE(body.cells.empty());
    for (const surface_cell& c : body.cells) {
      const auto node = [&](std::uint32_t i, std::uint32_t j) {
        return body.nodes[c.first + std::size_t{j} * c.columns + i].clearance_m;
      };
      double most = 0.0;
      for (std::uint32_t j = 0; j < c.rows; ++j) {
        for (std::uint32_t i = 0; i < c.columns; ++i) {
          most = std::max<double>(most, node(i, j));
          // relief_map::find() knows nothing of the outermost ring, and a spline reaches two nodes.
          const bool border = i < 3 || j < 3 || i + 3 >= c.columns || j + 3 >= c.rows;
          ASSERT_TRUE(!border || node(i, j) <= 0.0F);
          if (i + 1 == c.columns || j + 1 == c.rows) continue;
          ASSERT_LE(std::fabs(node(i, j) - node(i + 1, j)), 1.2001 * c.pitch_m);
          ASSERT_LE(std::fabs(node(i, j) - node(i, j + 1)), 1.2001 * c.pitch_m);
          ASSERT_LE(std::fabs(node(i, j) - node(i + 1, j + 1)), 1.2001 * std::sqrt(2.0) * c.pitch_m);
        }
      }
      EXPECT_GT(most, 0.0);
    }
  }
}

TEST(Clearance, GoesOnIntoTheWallBesideAConcaveEdge) {
  const surface_cells block = cut(corner_block(0.01, 0.005), 1e-4);
  clearance_reader inner(block, {1, 0, 0});
  for (const surface_cell& c : block.cells) {  // of the two faces that look along +x, the one in the corner
    if (c.n_b.x > 0.999 && std::fabs(c.origin_b.x) < 1e-9) inner.cell = &c;
  }
  ASSERT_LT(std::fabs(inner.cell->origin_b.x), 1e-9);
  // The face x = 0 runs from the inner corner y = 0 to y = 0.01. Nothing fades at the corner.
  EXPECT_GT(inner({0.0, 2e-4, 0.0}), 5e-4);
  EXPECT_GT(inner({0.0, 0.0, 0.0}), 5e-4);
  EXPECT_GT(inner({0.0, -3e-4, 0.0}), 2e-4);
  EXPECT_LE(inner({0.0, -1.2e-3, 0.0}), 0.0);  // the apron has ended
  // At its other end it fades as any face does.
  EXPECT_NEAR(inner({0.0, 0.01 - 3e-4, 0.0}), 3e-4, 1e-5);
}

TEST(Clearance, ARegionSmallerThanAPitchHasNone) {
  const surface_cells speck = cut(test::box_mesh({0.01, 0.01, 2e-6}), 1e-3);
  int faces = 0;
  for (const surface_cell& c : speck.cells) {
    if (c.highest_m >= c.lowest_m) ++faces;
  }
  EXPECT_GE(faces, 2);  // the large ones; a wall without a node is no cell
  for (const relief_node& n : speck.nodes) ASSERT_TRUE(std::isfinite(n.clearance_m) && std::isfinite(n.height_m));
}

}  // namespace
}  // namespace asperity
