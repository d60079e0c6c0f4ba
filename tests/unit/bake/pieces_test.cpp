#include "bake/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "bake/check.hpp"
#include "bake/collapse.hpp"
#include "bake/convex_hull.hpp"
#include "bake/geometry.hpp"
#include "bake/triangle_bvh.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

double volume(const std::vector<vec3>& points, const std::vector<index_triangle>& faces) {
  double v = 0.0;
  for (const index_triangle& f : faces) v += glm::dot(points[f[0]], glm::cross(points[f[1]], points[f[2]])) / 6.0;
  return v;
}

std::vector<index_triangle> hull_of(const std::vector<vec3>& points) {
  const std::vector<lattice_point> lattice = to_lattice(points, bounds_of(points));
  convex_hull hull(lattice);
  for (std::uint32_t v = 0; v < points.size(); ++v) hull.insert(v);
  return hull.faces();
}

void expect_convex_and_closed(const std::vector<vec3>& points, const std::vector<index_triangle>& faces, double slack) {
  EXPECT_TRUE(connect(faces, points.size()).closed_manifold());
  for (const index_triangle& f : faces) {
    const auto c = corners(points, f);
    const vec3 n = unit_normal(c);
    for (const vec3& p : points) EXPECT_LE(glm::dot(n, p - c[0]), slack);
  }
}

TEST(ConvexHull, OfACubeWithPointsOnItsFacesAndInside) {
  std::vector<vec3> points;
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j)
      for (int k = 0; k <= 4; ++k) points.emplace_back(i, j, k);
  const auto faces = hull_of(points);
  EXPECT_NEAR(volume(points, faces), 64.0, 1e-9);
  expect_convex_and_closed(points, faces, 1e-12);
}

TEST(ConvexHull, OfPointsOnASphereHoldsAllOfThem) {
  shapes::dice roll(5);
  std::vector<vec3> points;
  for (int i = 0; i < 300; ++i) points.push_back(glm::normalize(vec3(roll(-1, 1), roll(-1, 1), roll(-1, 1))));
  const auto faces = hull_of(points);
  EXPECT_EQ(faces.size(), 2 * points.size() - 4);
  expect_convex_and_closed(points, faces, 1e-7);
}

TEST(ConvexHull, IsExactOnNearlyFlatSets) {
  // Few enough lattice steps that 64 bits hold the test's own determinants.
  shapes::dice roll(6);
  for (const std::size_t thickness : {1UL, 2UL, 3UL, 50UL, 1000UL})
    for (int round = 0; round < 20; ++round) {
      std::vector<lattice_point> points;
      for (int i = 0; i < 40; ++i)
        points.push_back({static_cast<std::int64_t>(roll.below(1 << 20)),
                          static_cast<std::int64_t>(roll.below(1 << 20)),
                          static_cast<std::int64_t>(roll.below(thickness))});
      convex_hull hull(points);
      for (std::uint32_t v = 0; v < points.size(); ++v) hull.insert(v);
      EXPECT_EQ(hull.is_solid(), thickness > 1);
      EXPECT_TRUE(connect(hull.faces(), points.size()).closed_manifold());
      for (const index_triangle& f : hull.faces()) {
        const lattice_point& o = points[f[0]];
        const auto from = [&o](const lattice_point& p) { return std::array{p.x - o.x, p.y - o.y, p.z - o.z}; };
        const auto a = from(points[f[1]]);
        const auto b = from(points[f[2]]);
        for (const lattice_point& p : points) {
          const auto c = from(p);
          EXPECT_LE((a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
                        (a[0] * b[1] - a[1] * b[0]) * c[2],
                    0);
        }
      }
    }
}

TEST(ConvexHull, PolygonOfPlanePointsRunsCounterClockwise) {
  const vec3 normal = glm::normalize(vec3(1, 2, 3));
  const vec3 u = any_orthogonal(normal);
  const vec3 v = glm::cross(normal, u);
  std::vector<vec3> points;
  for (int i = 0; i <= 2; ++i)
    for (int j = 0; j <= 2; ++j) points.push_back(static_cast<double>(i) * u + static_cast<double>(j) * v);
  const auto polygon = convex_polygon(points, normal);
  ASSERT_EQ(polygon.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    const vec3 a = points[polygon[(k + 1) % 4]] - points[polygon[k]];
    const vec3 b = points[polygon[(k + 2) % 4]] - points[polygon[(k + 1) % 4]];
    EXPECT_NEAR(glm::dot(glm::cross(a, b), normal), 4.0, 1e-9);
  }
}

std::vector<convex_piece> pieces_of(const triangle_mesh& mesh) {
  stage_monitor monitor;
  return *decompose(mesh, piece_limits{}, monitor);
}

void expect_partition(const triangle_mesh& mesh, const std::vector<convex_piece>& pieces) {
  std::vector<int> seen(mesh.triangles.size(), 0);
  for (const convex_piece& p : pieces)
    for (const std::uint32_t t : p.triangles) ++seen[t];
  for (const int n : seen) EXPECT_EQ(n, 1);
}

// Every property that the finder counts on, measured without the code that made the pieces.
void expect_good_pieces(const triangle_mesh& mesh, const std::vector<convex_piece>& pieces) {
  const double diagonal = bounds_of(mesh.positions).diagonal();
  const triangle_bvh surface(mesh.positions, mesh.triangles);
  expect_partition(mesh, pieces);
  for (const convex_piece& p : pieces) {
    for (const vec3& v : p.vertices)
      EXPECT_NE(std::find(mesh.positions.begin(), mesh.positions.end(), v), mesh.positions.end());
    if (p.flat) {
      EXPECT_EQ(p.hull.size(), p.vertices.size() - 2);
      vec3 outward{0.0};
      for (const std::uint32_t t : p.triangles) outward += area_normal(corners(mesh.positions, mesh.triangles[t]));
      for (const auto& f : p.hull) EXPECT_GT(glm::dot(outward, area_normal(corners(p.vertices, f))), 0.0);
    } else {
      expect_convex_and_closed(p.vertices, p.hull, 1e-6 * diagonal);
      EXPECT_GT(volume(p.vertices, p.hull), 0.0);
    }
    const triangle_bvh hull(p.vertices, p.hull);
    shapes::dice roll(11);
    for (const std::uint32_t t : p.triangles) {
      const auto c = corners(mesh.positions, mesh.triangles[t]);
      for (int i = 0; i < 10; ++i) {
        const auto b = roll.barycentric();
        EXPECT_LE(hull.closest(b[0] * c[0] + b[1] * c[1] + b[2] * c[2]).distance_m, 1e-3 * diagonal);
      }
    }
    for (const auto& f : p.hull) {
      const auto c = corners(p.vertices, f);
      for (int i = 0; i < 10; ++i) {
        const auto b = roll.barycentric();
        const vec3 q = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
        const auto near = surface.closest(q);
        const vec3 n = unit_normal(corners(mesh.positions, mesh.triangles[near.triangle]));
        const bool outside = glm::dot(n, q - near.point) > 0.99 * near.distance_m;
        if (outside) {
          EXPECT_LE(near.distance_m, 5e-3 * diagonal);  // bridged air: 0.4 % and the spacing of its samples
        }
      }
    }
  }
}

TEST(Pieces, AConvexMeshIsOnePiece) {
  const triangle_mesh cube = shapes::box({0.04, 0.04, 0.04}, {1, 1, 1});
  const auto pieces = pieces_of(cube);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_FALSE(pieces[0].flat);
  EXPECT_EQ(pieces[0].vertices.size(), 8u);
  EXPECT_NEAR(volume(pieces[0].vertices, pieces[0].hull), 6.4e-5, 1e-12);
  expect_good_pieces(cube, pieces);
}

TEST(Pieces, EveryConvexComponentIsOnePiece) {
  const triangle_mesh box = shapes::box({0.04, 0.03, 0.02}, {3, 3, 3});
  const triangle_mesh two = shapes::both(box, shapes::scaled(box, 1.0, {0.1, 0.0, 0.0}));
  EXPECT_EQ(pieces_of(two).size(), 2u);
}

TEST(Pieces, ASlotIsNotBridged) {
  // A bar with a notch from above: its two ends and the notch's floor cannot share a hull.
  const triangle_mesh slotted = shapes::box({0.06, 0.02, 0.02}, {3, 1, 1}, [](vec3 p) {
    return std::abs(p.x) < 0.011 && p.z > 0.009 ? vec3(p.x, p.y, -0.005) : p;
  });
  ASSERT_TRUE(check(slotted).has_value()) << check(slotted).error().message;
  const auto pieces = pieces_of(slotted);
  EXPECT_GE(pieces.size(), 3u);
  expect_good_pieces(slotted, pieces);
}

TEST(Pieces, AShallowDentStaysOutOfTheHullAround) {
  // 0.3 % of the diagonal: the lid may bridge so much air, but the dent's own triangles lie too deep below it.
  const triangle_mesh dented = shapes::box({0.04, 0.04, 0.06}, {2, 2, 1}, [](vec3 p) {
    return p.x == 0.0 && p.y == 0.0 && p.z > 0.0 ? p - vec3(0.0, 0.0, 0.00024) : p;
  });
  const auto pieces = pieces_of(dented);
  expect_good_pieces(dented, pieces);
}

TEST(Pieces, AChamberBehindANarrowSlitStaysEmpty) {
  // The slit is narrower than the air that a hull may bridge; what lies behind it is not.
  const triangle_mesh keyhole = shapes::cells(
      {{{-0.02, -0.008, -0.00005, 0.00005, 0.008, 0.02}, {-0.02, -0.01, 0.01, 0.02}, {0.0, 0.006, 0.014, 0.02}}},
      [](const std::array<int, 3>& c) {
        const bool chamber = c[1] == 1 && c[2] == 1 && c[0] >= 1 && c[0] <= 3;
        const bool slit = c[1] == 1 && c[2] == 2 && c[0] == 2;
        return !chamber && !slit;
      });
  ASSERT_TRUE(check(keyhole).has_value()) << check(keyhole).error().message;
  const auto pieces = pieces_of(keyhole);
  expect_good_pieces(keyhole, pieces);
  const vec3 centre{0.001, 0.0, 0.0105};
  for (const convex_piece& p : pieces) {
    if (p.flat) continue;
    double outside = 0.0;
    for (const auto& f : p.hull) {
      const auto c = corners(p.vertices, f);
      outside = std::max(outside, glm::dot(unit_normal(c), centre - c[0]));
    }
    EXPECT_GT(outside, 0.0);
  }
}

TEST(Pieces, ASaddleGivesFlatPieces) {
  stage_monitor monitor;
  shapes::wavy_torus torus;
  torus.amplitude_m = 0.0;
  const triangle_mesh coarse = *collapse_edges(torus.mesh(80, 40), 400, monitor);
  const auto pieces = pieces_of(coarse);
  EXPECT_GT(pieces.size(), 10u);
  EXPECT_LT(pieces.size(), 200u);
  expect_good_pieces(coarse, pieces);
}

TEST(Pieces, AThinPlateStaysSolid) {
  const triangle_mesh plate = shapes::box({0.1, 0.1, 1e-4}, {1, 1, 1});
  const auto pieces = pieces_of(plate);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_FALSE(pieces[0].flat);
}

}  // namespace
}  // namespace asperity::bake
