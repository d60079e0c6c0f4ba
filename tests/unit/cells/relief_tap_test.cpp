// Between its nodes a map is smooth, exact for parabolas, and no steeper than what shortcuts take for granted.
#include "asperity/cells/relief_tap.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <limits>

#include "asperity/cells/cell_grid.hpp"
#include "support/random_hulls.hpp"

namespace asperity {
namespace {

using detail::relief_map;
using detail::relief_tap;

constexpr std::uint32_t columns = 12, rows = 9;
constexpr double grid_pitch = 0.125;

/// A body of one cell whose nodes are told by (column, row).
surface_cells body_with(const std::function<relief_node(double, double)>& node) {
  surface_cells body;
  surface_cell cell;
  cell.low = {-0.5, 0.25};
  cell.pitch_m = grid_pitch;
  cell.columns = columns;
  cell.rows = rows;
  cell.first = 3;  // nodes of an earlier cell
  body.nodes.assign(3, {1e6F, 1e6F});
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) body.nodes.push_back(node(i, j));
  }
  body.cells.push_back(cell);
  return body;
}

surface_cells random_body(std::uint64_t seed) {
  test::uniform_source random(seed);
  return body_with([&](double, double) {
    return relief_node{static_cast<float>(random(-1, 1)), static_cast<float>(random(-1, 1))};
  });
}

void expect_same(const relief_tap& a, const relief_tap& b) {
  EXPECT_NEAR(a.height_m, b.height_m, 1e-12);
  EXPECT_NEAR(a.clearance_m, b.clearance_m, 1e-12);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(a.height_slope[k], b.height_slope[k], 1e-11);
    EXPECT_NEAR(a.clearance_slope[k], b.clearance_slope[k], 1e-11);
  }
}

TEST(ReliefMap, ValueAndSlopeAreContinuousOverNodeLines) {
  const surface_cells body = random_body(1);
  const relief_map map(body, body.cells[0]);
  for (std::size_t j = 1; j + 3 < rows; ++j) {
    for (std::size_t i = 1; i + 3 < columns; ++i) {
      for (const double t : {0.0, 0.3, 0.5, 0.99}) {
        expect_same(map.read({i, j, 1.0, t}), map.read({i + 1, j, 0.0, t}));
        expect_same(map.read({i, j, t, 1.0}), map.read({i, j + 1, t, 0.0}));
      }
    }
  }
}

TEST(ReliefMap, PassesThroughItsNodes) {
  const surface_cells body = random_body(2);
  const relief_map map(body, body.cells[0]);
  for (std::size_t j = 1; j + 2 < rows; ++j) {
    for (std::size_t i = 1; i + 2 < columns; ++i) {
      const relief_node& node = body.nodes[3 + j * columns + i];
      const relief_tap tap = map.read({i, j, 0.0, 0.0});
      EXPECT_EQ(tap.height_m, node.height_m);
      EXPECT_EQ(tap.clearance_m, node.clearance_m);
      EXPECT_EQ(&map.near_node({i, j, 0.7, 0.2}), &node);
    }
  }
}

TEST(ReliefMap, ReproducesParabolasExactly) {
  const auto height = [](double x, double y) { return 2.0 - x + 3.0 * y + 0.5 * x * x - x * y + 0.25 * y * y; };
  const auto clearance = [](double x, double y) { return x * x * y * y / 64.0 - y; };
  // A float holds these numbers exactly at the nodes.
  const surface_cells body = body_with([&](double i, double j) {
    return relief_node{static_cast<float>(height(i, j)), static_cast<float>(clearance(i, j))};
  });
  const relief_map map(body, body.cells[0]);
  test::uniform_source random(3);
  for (int n = 0; n < 200; ++n) {
    const double x = random(1.0, columns - 2.0), y = random(1.0, rows - 2.0);
    relief_map::place at{};
    ASSERT_TRUE(map.find(-0.5 + grid_pitch * x, 0.25 + grid_pitch * y, at));
    const relief_tap tap = map.read(at);
    EXPECT_NEAR(tap.height_m, height(x, y), 1e-12);
    EXPECT_NEAR(tap.clearance_m, clearance(x, y), 1e-11);
    EXPECT_NEAR(tap.height_slope.x, (-1.0 + x - y) / grid_pitch, 1e-10);
    EXPECT_NEAR(tap.height_slope.y, (3.0 - x + 0.5 * y) / grid_pitch, 1e-10);
    EXPECT_NEAR(tap.clearance_slope.x, x * y * y / 32.0 / grid_pitch, 1e-10);
    EXPECT_NEAR(tap.clearance_slope.y, (x * x * y / 32.0 - 1.0) / grid_pitch, 1e-10);
  }
}

TEST(ReliefMap, SlopesAreTheDerivatives) {
  const surface_cells body = random_body(4);
  const relief_map map(body, body.cells[0]);
  test::uniform_source random(5);
  const auto read = [&](double x, double y) {
    relief_map::place at{};
    EXPECT_TRUE(map.find(x, y, at));
    return map.read(at);
  };
  constexpr double h = 1e-6;
  for (int n = 0; n < 100; ++n) {
    const double x = -0.5 + grid_pitch * random(1.1, columns - 2.1), y = 0.25 + grid_pitch * random(1.1, rows - 2.1);
    const relief_tap tap = read(x, y), east = read(x + h, y), west = read(x - h, y), north = read(x, y + h),
                     south = read(x, y - h);
    EXPECT_NEAR(tap.height_slope.x, (east.height_m - west.height_m) / (2 * h), 1e-6);
    EXPECT_NEAR(tap.height_slope.y, (north.height_m - south.height_m) / (2 * h), 1e-6);
    EXPECT_NEAR(tap.clearance_slope.x, (east.clearance_m - west.clearance_m) / (2 * h), 1e-6);
    EXPECT_NEAR(tap.clearance_slope.y, (north.clearance_m - south.clearance_m) / (2 * h), 1e-6);
  }
}

TEST(ReliefMap, KnowsWhereItEnds) {
  const surface_cells body = random_body(6);
  const relief_map map(body, body.cells[0]);
  relief_map::place at{};
  const auto found = [&](double column, double row) {
    return map.find(-0.5 + grid_pitch * column, 0.25 + grid_pitch * row, at);
  };
  EXPECT_TRUE(found(1.0, 1.0));
  EXPECT_TRUE(found(columns - 2.001, rows - 2.001));
  EXPECT_EQ(at.column, columns - 3U);
  EXPECT_EQ(at.row, rows - 3U);
  EXPECT_FALSE(found(0.999, 3.0));
  EXPECT_FALSE(found(3.0, 0.999));
  EXPECT_FALSE(found(columns - 2.0, 3.0));
  EXPECT_FALSE(found(3.0, rows - 2.0));
  EXPECT_FALSE(found(1e300, 3.0));
  EXPECT_FALSE(found(std::numeric_limits<double>::quiet_NaN(), 3.0));
}

// cell_depth skips most samples by one node, and trusts that the surface rises no further within its square.
TEST(ReliefMap, RisesLessThanTwiceTheSlopeLimitOverANode) {
  test::uniform_source random(7);
  constexpr double slope = 1.0;
  double most = 0.0;
  for (int n = 0; n < 400; ++n) {
    const double size = random(0.1, 3.0) * grid_pitch;
    surface_cells body = body_with([&](double, double) {
      return relief_node{static_cast<float>(random(0.0, 1.0) < 0.5 ? -size : size), 0.0F};
    });
    std::vector<float> heights;
    for (std::size_t i = 3; i < body.nodes.size(); ++i) heights.push_back(body.nodes[i].height_m);
    detail::cell_grid{&body.cells[0]}.limit_slope(heights, slope, -1.0F);
    for (std::size_t i = 0; i < heights.size(); ++i) body.nodes[3 + i].height_m = heights[i];
    const relief_map map(body, body.cells[0]);
    for (std::size_t j = 1; j + 2 < rows; ++j) {
      for (std::size_t i = 1; i + 2 < columns; ++i) {
        for (double x = 0.0; x <= 1.0; x += 0.1) {
          for (double y = 0.0; y <= 1.0; y += 0.1) {
            const relief_map::place at{i, j, x, y};
            most = std::max(most, map.read(at).height_m - map.near_node(at).height_m);
          }
        }
      }
    }
  }
  std::printf("largest rise over a node: %.3f pitches at slope 1\n", most / grid_pitch);
  EXPECT_GT(most, 1.2 * slope * grid_pitch);  // the test does find steep places
  EXPECT_LE(most, 2.0 * slope * grid_pitch);
}

}  // namespace
}  // namespace asperity
