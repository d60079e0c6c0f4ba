// The grid's operations against slow, plain versions of themselves.
#include "asperity/cells/cell_grid.hpp"

#include <gtest/gtest.h>

#include "support/random_hulls.hpp"

namespace asperity {
namespace {

using detail::cell_grid;

surface_cell sheet(std::uint32_t columns, std::uint32_t rows, double pitch) {
  surface_cell cell;
  cell.origin_b = {0.3, -0.2, 0.1};
  cell.u_b = {0.0, 1.0, 0.0};
  cell.v_b = {0.0, 0.0, 1.0};
  cell.n_b = {1.0, 0.0, 0.0};
  cell.low = {-0.01, -0.02};
  cell.pitch_m = pitch;
  cell.columns = columns;
  cell.rows = rows;
  return cell;
}

vec3 body_point(const surface_cell& cell, const vec3& p) {
  return cell.origin_b + p.x * cell.u_b + p.y * cell.v_b + p.z * cell.n_b;
}

TEST(CellGrid, PositionAndGridCoordinatesAreInverse) {
  const surface_cell cell = sheet(7, 5, 1e-3);
  const cell_grid grid{&cell};
  ASSERT_EQ(grid.size(), 35U);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const vec3 at = grid.to_grid(body_point(cell, vec3(grid.position(i), 4e-4)));
    EXPECT_NEAR(at.x, static_cast<double>(i % 7), 1e-9);
    EXPECT_NEAR(at.y, static_cast<double>(i / 7), 1e-9);
    EXPECT_NEAR(at.z, 4e-4, 1e-15);
  }
}

TEST(CellGrid, FillReachesTheNodesUnderATriangleAndTellsItsHeight) {
  const surface_cell cell = sheet(20, 15, 1e-3);
  const cell_grid grid{&cell};
  test::uniform_source random(1);
  const auto point = [&] { return vec3(random(-5.0, 25.0), random(-5.0, 20.0), random(-1.0, 1.0)); };
  for (int n = 0; n < 200; ++n) {
    const vec3 a = point(), b = point(), c = point();
    std::vector<int> times(grid.size(), 0);
    std::vector<double> height(grid.size(), 0.0);
    grid.fill(a, b, c, [&](std::size_t i, double h) {
      ++times[i];
      height[i] = h;
    });
    const vec3 normal = glm::cross(b - a, c - a);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const vec2 p(static_cast<double>(i % 20), static_cast<double>(i / 20));
      const auto side = [&](const vec3& from, const vec3& to) {
        return (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
      };
      const double s[3] = {side(a, b), side(b, c), side(c, a)};
      if (std::min({std::fabs(s[0]), std::fabs(s[1]), std::fabs(s[2])}) < 1e-6) continue;  // on an edge: either
      const bool inside = (s[0] > 0.0) == (s[1] > 0.0) && (s[1] > 0.0) == (s[2] > 0.0);
      ASSERT_EQ(times[i], inside ? 1 : 0);
      if (!inside) continue;
      const double expected = a.z - (normal.x * (p.x - a.x) + normal.y * (p.y - a.y)) / normal.z;
      ASSERT_NEAR(height[i], expected, 1e-9 * (1.0 + std::fabs(1.0 / normal.z)));
    }
  }
}

TEST(CellGrid, TrianglesThatShareAnEdgeLeaveNoNodeOut) {
  const surface_cell cell = sheet(13, 13, 1e-3);
  const cell_grid grid{&cell};
  const vec3 a(0, 0, 0), b(12, 0, 0), c(12, 12, 0), d(0, 12, 0), middle(6, 6, 0);  // all edges run through nodes
  std::vector<int> times(grid.size(), 0);
  const auto count = [&](std::size_t i, double) { ++times[i]; };
  grid.fill(a, b, middle, count);
  grid.fill(b, c, middle, count);
  grid.fill(d, middle, c, count);  // winding does not matter
  grid.fill(d, a, middle, count);
  EXPECT_EQ(*std::min_element(times.begin(), times.end()), 1);
}

TEST(CellGrid, FillTakesNothingFromATriangleWithoutAreaOrFarAway) {
  const surface_cell cell = sheet(9, 9, 1e-3);
  const cell_grid grid{&cell};
  int put = 0;
  const auto count = [&](std::size_t, double) { ++put; };
  grid.fill({1, 1, 0}, {5, 5, 0}, {3, 3, 1}, count);
  for (const double far : {1e3, 1e18, 1e30}) {
    grid.fill({far, 0, 0}, {2 * far, 0, 0}, {far, far, 0}, count);
    grid.fill({-far, 0, 0}, {-2 * far, 0, 0}, {-far, -far, 0}, count);
  }
  EXPECT_EQ(put, 0);
  // One corner far away: the part over the grid counts.
  grid.fill({-1, -1, 0}, {1e30, -1, 0}, {-1, 1e30, 0}, count);
  EXPECT_EQ(put, 81);
}

TEST(CellGrid, DistanceIsTheNearestNodeOfTheSet) {
  test::uniform_source random(2);
  for (const auto& [columns, rows] : {std::pair{17U, 11U}, std::pair{3U, 29U}, std::pair{24U, 24U}}) {
    const surface_cell cell = sheet(columns, rows, 2e-4);
    const cell_grid grid{&cell};
    for (const double density : {0.005, 0.05, 0.5}) {
      std::vector<char> set(grid.size());
      for (char& s : set) s = random(0.0, 1.0) < density ? 1 : 0;
      constexpr double far = 1.5e-3;
      const std::vector<float> distance = grid.distance_to(set, far);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        double nearest = far;
        for (std::size_t j = 0; j < grid.size(); ++j) {
          if (set[j] != 0) nearest = std::min(nearest, glm::distance(grid.position(i), grid.position(j)));
        }
        ASSERT_NEAR(distance[i], nearest, 1e-6 * far);
      }
    }
  }
}

TEST(CellGrid, DistanceToNothingIsFar) {
  const surface_cell cell = sheet(12, 9, 1e-6);
  const cell_grid grid{&cell};
  for (const double far : {0.5, 1e9}) {
    const std::vector<float> distance = grid.distance_to(std::vector<char>(grid.size(), 0), far);
    ASSERT_EQ(distance.size(), 12U * 9U);
    for (const float d : distance) {
      ASSERT_EQ(d, static_cast<float>(far));
    }
  }
}

// Between two nodes the shortest way along neighbours has as many diagonal steps as the shorter side allows.
double octile(const cell_grid& grid, std::size_t i, std::size_t j) {
  const vec2 d = glm::abs(grid.position(i) - grid.position(j));
  return std::max(d.x, d.y) + (std::sqrt(2.0) - 1.0) * std::min(d.x, d.y);
}

TEST(CellGrid, LimitSlopeIsTheNearestFieldOfThatSlope) {
  const surface_cell cell = sheet(14, 10, 1e-3);
  const cell_grid grid{&cell};
  test::uniform_source random(3);
  for (const float sign : {+1.0F, -1.0F}) {
    for (const double slope : {0.5, 1.2, 3.0}) {
      std::vector<float> given(grid.size());
      for (float& f : given) f = static_cast<float>(random(-1e-2, 1e-2));
      std::vector<float> limited = given;
      grid.limit_slope(limited, slope, sign);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        double expected = given[i];
        for (std::size_t j = 0; j < grid.size(); ++j) {
          const double reached = given[j] + sign * slope * octile(grid, i, j);
          expected = sign > 0.0F ? std::min(expected, reached) : std::max(expected, reached);
        }
        ASSERT_NEAR(limited[i], expected, 1e-8);
      }
    }
  }
}

TEST(CellGrid, BlurSpreadsANodeOverItsNeighboursAndKeepsTheSum) {
  const surface_cell cell = sheet(9, 8, 1e-3);
  const cell_grid grid{&cell};
  std::vector<float> f(grid.size(), 0.0F);
  f[4 * 9 + 4] = 9.0F;
  grid.blur(f, 1);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const bool near = i % 9 >= 3 && i % 9 <= 5 && i / 9 >= 3 && i / 9 <= 5;
    EXPECT_FLOAT_EQ(f[i], near ? 1.0F : 0.0F);
  }
  std::vector<float> level(grid.size(), 0.25F);
  grid.blur(level, 3);
  for (const float x : level) EXPECT_FLOAT_EQ(x, 0.25F);  // at the border too
}

}  // namespace
}  // namespace asperity
