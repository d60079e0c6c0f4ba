// Sharp edges are merged where they are straight and reach on where they turn a little.
#include "asperity/cells/sharp_edges.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include "asperity/cells/make_surface_cells.hpp"
#include "meshes.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using detail::find_sharp_edges;
using test_support::corner_block;
using test_support::cut_model;

constexpr double reach = 1e-3;

std::vector<sharp_edge> edges_of(const cut_model& cut) {
  return find_sharp_edges(cut.model.mesh, cut.index, cut.regions, reach);
}

TEST(SharpEdges, CollinearPiecesAreOne) {
  for (const std::uint32_t cells : {1U, 2U, 5U}) {
    const cut_model box(test::box_mesh({0.01, 0.01, 0.01}, cells));
    const std::vector<sharp_edge> edges = edges_of(box);
    ASSERT_EQ(edges.size(), 12U);
    for (const sharp_edge& e : edges) {
      EXPECT_NEAR(e.length_m, 0.02, 1e-15);
      EXPECT_EQ(e.extension_m[0], 0.0);
      EXPECT_EQ(e.extension_m[1], 0.0);
      // From a corner of the box to a corner of the box.
      for (const vec3& p : {e.from_b, e.from_b + e.length_m * e.along_b}) {
        EXPECT_LT(glm::length(glm::abs(p) - 0.01), 1e-12);
      }
    }
  }
}

TEST(SharpEdges, FaceDirectionsLeadAwayFromTheEdgeAlongTheSurface) {
  const cut_model block(corner_block(0.01, 0.005));
  const std::vector<sharp_edge> edges = edges_of(block);
  ASSERT_EQ(edges.size(), 17U);
  for (const sharp_edge& e : edges) {
    const vec3 middle = e.from_b + 0.5 * e.length_m * e.along_b;
    for (const vec3& f : e.face_b) {
      EXPECT_NEAR(glm::length(f), 1.0, 1e-12);
      EXPECT_NEAR(glm::dot(f, e.along_b), 0.0, 1e-12);
      // A little way along it lies on a face: in the block just below the surface, not above it.
      const vec3 p = middle + 1e-4 * f;
      const vec3 q = glm::abs(p);
      const bool in_box = q.x <= 0.01 + 1e-9 && q.y <= 0.01 + 1e-9 && q.z <= 0.005 + 1e-9;
      EXPECT_TRUE(in_box && !(p.x > 1e-9 && p.y > 1e-9));
    }
    EXPECT_NEAR(glm::dot(e.face_b[0], e.face_b[1]), 0.0, 1e-12);
  }
}

TEST(SharpEdges, ReachOnWhereTheChainTurnsALittle) {
  const cut_model drum(test::prism_mesh(test::regular_polygon(12, 0.01), 0.01));
  int rim = 0, upright = 0;
  for (const sharp_edge& e : edges_of(drum)) {
    const bool is_upright = std::fabs(e.along_b.z) > 0.5;
    ++(is_upright ? upright : rim);
    const double expected = is_upright ? 0.0 : reach;  // the rim turns 30 degrees at a time, uprights end at a corner
    EXPECT_EQ(e.extension_m[0], expected);
    EXPECT_EQ(e.extension_m[1], expected);
  }
  EXPECT_EQ(rim, 24);
  EXPECT_EQ(upright, 12);
}

TEST(SharpEdges, EndWhereTheChainTurnsSharply) {
  const std::vector<sharp_edge> edges = edges_of(cut_model(test::prism_mesh(test::regular_polygon(6, 0.01), 0.01)));
  EXPECT_EQ(edges.size(), 18U);
  for (const sharp_edge& e : edges) {
    EXPECT_EQ(e.extension_m[0], 0.0);
    EXPECT_EQ(e.extension_m[1], 0.0);
  }
}

TEST(SharpEdges, AChainThatTurnsVeryLittleIsStraight) {
  // A square whose lower side sags by half a degree in its middle.
  const double sag = 0.01 * std::tan(0.25 * std::numbers::pi / 180.0);
  const cut_model bar(
      test::prism_mesh({{0.01, 0.01}, {-0.01, 0.01}, {-0.01, -0.01}, {0.0, -0.01 - sag}, {0.01, -0.01}}, 0.01));
  const std::vector<sharp_edge> edges = edges_of(bar);
  EXPECT_EQ(edges.size(), 12U);
  for (const sharp_edge& e : edges) {
    EXPECT_NEAR(e.length_m, 0.02, 1e-6);
    EXPECT_NEAR(glm::length(e.along_b), 1.0, 1e-12);
  }
}

TEST(SharpEdges, AnOpenBorderIsNone) {
  EXPECT_TRUE(edges_of(cut_model(test::triangle_mesh_of({vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)}))).empty());
}

// The tree that the finder asks must hold an edge with both its extensions, whichever way it runs.
TEST(SharpEdges, TheTreeFindsAnEdgeByAnyPointOfIt) {
  std::vector<vec2> outline;  // turns by 20 to 90 degrees: an edge may go on at one of its ends alone
  for (const double degrees : {0.0, 20.0, 40.0, 130.0, 220.0, 310.0}) {
    const double a = degrees * std::numbers::pi / 180.0;
    outline.push_back(0.01 * vec2(std::cos(a), std::sin(a)));
  }
  const textured_model drum = test_support::bare_model(test::prism_mesh(outline, 0.01));
  cell_settings coarse;
  coarse.pitch_m = 5e-4;
  const auto made = make_surface_cells(drum, coarse);
  ASSERT_TRUE(made);
  const surface_cells& body = made.value();
  int one_sided = 0;
  for (std::uint32_t i = 0; i < body.edges.size(); ++i) {
    const sharp_edge& e = body.edges[i];
    one_sided += (e.extension_m[0] > 0.0) != (e.extension_m[1] > 0.0) ? 1 : 0;
    for (const int side : {0, 1}) {  // it reaches on at the end where another one goes on
      const vec3 end = e.from_b + side * e.length_m * e.along_b, heading = (2.0 * side - 1.0) * e.along_b;
      const bool goes_on = std::any_of(body.edges.begin(), body.edges.end(), [&](const sharp_edge& o) {
        const bool starts = glm::distance(o.from_b, end) < 1e-9;
        const bool ends = glm::distance(o.from_b + o.length_m * o.along_b, end) < 1e-9;
        return &o != &e && ((starts && glm::dot(o.along_b, heading) > std::cos(0.7)) ||
                            (ends && glm::dot(-o.along_b, heading) > std::cos(0.7)));
      });
      EXPECT_EQ(e.extension_m[side] > 0.0, goes_on);
    }
    for (const double s : {-e.extension_m[0], 0.3 * e.length_m, e.length_m + e.extension_m[1]}) {
      const vec3 p = e.from_b + s * e.along_b;
      int found = 0;
      body.edge_tree.query({p - 1e-12, p + 1e-12}, [&](std::uint32_t n) noexcept { found += n == i ? 1 : 0; });
      EXPECT_EQ(found, 1) << "edge " << i << " at " << s;
    }
  }
  EXPECT_GT(one_sided, 0);
}

using detail::read_edge_relief;

// The two charts that meet in an edge tell each of its own normal's part; half of each is the edge's.
TEST(EdgeRelief, LiesBetweenTheReliefsOfBothCharts) {
  const auto wave = [](double x) { return 1e-4 * std::sin(600.0 * x); };
  const textured_model box = test_support::make_textured_box(
      {0.01, 0.005, 0.008}, 384,
      [&](const vec3& p, const vec3& n) { return n.z > 0.5 ? wave(p.x) : (n.y > 0.5 ? 5e-5 : 0.0); });
  const auto made = make_surface_cells(box);
  ASSERT_TRUE(made);
  const surface_cells& body = made.value();
  int waving = 0;
  for (const sharp_edge& e : body.edges) {
    const vec3 middle = e.from_b + 0.5 * e.length_m * e.along_b;
    const bool top = middle.z > 0.0079, back = middle.y > 0.0049;
    // Not at the very ends: a texel at a corner knows of its own face alone.
    for (double f = 0.05; f < 0.951; f += 0.01) {
      const vec3 p = e.from_b + f * e.length_m * e.along_b;
      const vec3 expected(0.0, back ? 2.5e-5 : 0.0, top ? 0.5 * wave(p.x) : 0.0);
      vec3 slope;
      EXPECT_LT(glm::distance(read_edge_relief(body, e, f * e.length_m, slope), expected), 3e-6) << f;
    }
    waving += top && std::fabs(e.along_b.x) > 0.5 ? 1 : 0;
  }
  EXPECT_EQ(waving, 2);
  EXPECT_GE(body.largest_edge_relief_m, 0.5e-4);
  EXPECT_LE(body.largest_edge_relief_m, 0.6e-4 + 1e-6);
}

TEST(EdgeRelief, IsASplineThatEndsLevel) {
  surface_cells body;
  sharp_edge e;
  e.length_m = 0.02;
  for (const double z : {1.0, 2.0, -1.0, 0.5}) body.edge_relief.emplace_back(vec3(0.0, 1e-5, 1e-5 * z));
  e.first_relief = 1;  // its own nodes only: 2, -1, 0.5
  e.relief = 3;
  vec3 slope;
  const auto at = [&](double s) { return read_edge_relief(body, e, s, slope); };
  EXPECT_NEAR(at(0.0).z, 2e-5, 1e-11);
  EXPECT_NEAR(at(0.01).z, -1e-5, 1e-11);
  EXPECT_NEAR(at(0.02).z, 0.5e-5, 1e-11);
  for (double s = -0.005; s < 0.0251; s += 3.1e-4) {
    const vec3 by_difference = (at(s + 1e-7) - at(s - 1e-7)) / 2e-7;
    const vec3 value = at(s);
    EXPECT_LT(glm::distance(slope, by_difference), 1e-7) << s;
    EXPECT_NEAR(value.y, 1e-5, 1e-11);
    if (s < 0.0 || s > e.length_m) {
      EXPECT_EQ(value, at(s < 0.0 ? 0.0 : e.length_m)) << s;
    }
  }
  for (const double end : {0.0, 0.02}) {  // the slope is continuous there too
    static_cast<void>(at(end));
    EXPECT_LT(glm::length(slope), 1e-12) << end;
  }
}

TEST(EdgeRelief, OfAnEdgeWithoutOneIsFlat) {
  vec3 slope(1.0);
  EXPECT_EQ(read_edge_relief({}, {}, 0.5, slope), vec3(0.0));
  EXPECT_EQ(slope, vec3(0.0));
}

}  // namespace
}  // namespace asperity
