// The cell finder may list too much, never too little.
#include "asperity/collision/cell_finder.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <tuple>

#include "asperity/depth/cell_depth.hpp"
#include "support/box_pairs.hpp"

namespace asperity {
namespace {

using test_support::box_pair;
using test_support::everything;

using cell_key = std::tuple<std::uint32_t, bool, std::uint32_t>;  // body, on_probe, cell

shared_settings settings_with(double facing_none) {
  shared_settings s;
  s.tau_m = 3e-5;
  s.facing_none = facing_none;
  return s;
}

/// Cells, tiles and edges with weight at a pose, by measuring every tile against every cell.
struct weighty {
  std::set<std::tuple<std::uint32_t, bool, std::uint32_t, std::uint32_t>> tiles;
  std::set<std::tuple<std::uint32_t, std::uint32_t>> edges;

  weighty(const cell_scene& bodies, const cell_depth& depth, const scene_pose& at) {
    near_cells one({.cells = 1, .tiles = 1, .edges = 1});
    cell_reading r;
    for (const bool on_probe : {false, true}) {
      const surface_cells &Y = on_probe ? *bodies.probe : *bodies.fixed[0],
                          &X = on_probe ? *bodies.fixed[0] : *bodies.probe;
      for (std::uint32_t c = 0; c < Y.cells.size(); ++c) {
        for (std::uint32_t t = 0; t < X.tiles.size(); ++t) {
          one.clear();
          EXPECT_TRUE(one.add_cell(0, on_probe, c));
          one.add_tile(t);
          EXPECT_EQ(depth.measure(at, one, std::span(&r, 1)), status::ok);
          if (r.samples > 0) tiles.insert({0, on_probe, c, t});
        }
      }
    }
    for (std::uint32_t a = 0; a < bodies.probe->edges.size(); ++a) {
      for (std::uint32_t b = 0; b < bodies.fixed[0]->edges.size(); ++b) {
        one.clear();
        one.add_edges({0, a, b});
        EXPECT_EQ(depth.measure(at, one, std::span(&r, 1)), status::ok);
        if (r.samples > 0) edges.insert({a, b});
      }
    }
  }
};

void expect_superset(double facing_none) {
  const box_pair pair(2e-4);
  const shared_settings settings = settings_with(facing_none);
  const cell_depth depth(pair.cells, pair.bodies, settings);
  const cell_finder finder(pair.cells, cell_depth::reach_m(settings), settings.facing_none);
  test::uniform_source random(1);
  near_cells near;
  std::size_t needed = 0, listed = 0, needed_edges = 0, most = 0;
  for (int n = 0; n < 60; ++n) {
    const pose T_wa = pair.touching(random, random(-6e-4, 9e-4), n % 3 == 0 ? 3.0 : 0.6), T_wb;
    const scene_pose at{T_wa, std::span(&T_wb, 1)};
    ASSERT_EQ(finder.find(at, near), status::ok);
    weighty real(*pair.cells, depth, at);
    needed += real.tiles.size();
    needed_edges += real.edges.size();
    std::set<cell_key> cells;
    for (const near_cell& c : near.cells()) {
      EXPECT_TRUE(cells.insert({c.body, c.on_probe, c.cell}).second) << "a cell is listed once";
      EXPECT_GT(c.count, 0U);
      for (const std::uint32_t t : near.tiles(c)) real.tiles.erase({c.body, c.on_probe, c.cell, t});
      listed += c.count;
    }
    for (const near_edges& e : near.edges()) real.edges.erase({e.edge_a, e.edge_b});
    EXPECT_TRUE(real.tiles.empty()) << real.tiles.size() << " tiles with weight are missing in pose " << n;
    EXPECT_TRUE(real.edges.empty()) << real.edges.size() << " edges with weight are missing in pose " << n;
    most += pair.cells->probe->cells.size() * pair.cells->fixed[0]->tiles.size() +
            pair.cells->fixed[0]->cells.size() * pair.cells->probe->tiles.size();
  }
  std::printf("facing from %.2f: %zu of %zu pairs of cell and tile have weight, %zu are listed\n", facing_none, needed,
              most, listed);
  EXPECT_GT(needed, 500U);
  EXPECT_GT(needed_edges, 5U);
  EXPECT_LT(listed, most / 4);  // and yet it leaves most out
}

TEST(CellFinder, ListsAllThatHasWeight) { expect_superset(0.75); }

// The finder must know from where on a slanted face counts, or tiles leave with weight.
TEST(CellFinder, ListsAllThatHasWeightWhereSlantedFacesCountToo) { expect_superset(0.4); }

TEST(CellFinder, FarApartListsNothing) {
  const box_pair pair;
  const cell_finder finder(pair.cells, 6e-4, 0.75);
  near_cells near;
  const pose T_wb;
  ASSERT_EQ(finder.find({{{}, {0.0, 0.0, 0.05}}, std::span(&T_wb, 1)}, near), status::ok);
  EXPECT_EQ(near.size(), 0U);
}

TEST(CellFinder, DependsOnTheRelativePoseAlone) {
  const box_pair pair;
  const cell_finder finder(pair.cells, 6e-4, 0.75);
  test::uniform_source random(3);
  for (int n = 0; n < 20; ++n) {
    const pose T_wa = pair.touching(random, 1e-4, 0.5), T_wb, moved{exp_rotation({1, 2, 3}), {0.5, -0.2, 0.1}};
    near_cells here, there;
    ASSERT_EQ(finder.find({T_wa, std::span(&T_wb, 1)}, here), status::ok);
    ASSERT_EQ(finder.find({moved * T_wa, std::span(&moved, 1)}, there), status::ok);
    // A tile at the very border may go either way by the last digit.
    EXPECT_NEAR(static_cast<double>(here.size()), static_cast<double>(there.size()), 1.0);
  }
}

TEST(CellFinder, EveryFixedBodyHasItsOwnCells) {
  box_pair pair;
  cell_scene three = *pair.cells;
  three.fixed = {three.fixed[0], three.fixed[0], three.fixed[0]};
  const cell_finder finder(std::make_shared<const cell_scene>(three), 6e-4, 0.75);
  test::uniform_source random(4);
  const pose T_wa = pair.touching(random, 1e-4, 0.5);
  const std::vector<pose> T_wb{{}, {{}, {1.0, 0.0, 0.0}}, {}};
  near_cells near;
  ASSERT_EQ(finder.find({T_wa, T_wb}, near), status::ok);
  std::size_t count[3]{};
  std::uint32_t last = 0;
  for (const near_cell& c : near.cells()) {
    EXPECT_GE(c.body, last);  // sorted by body
    last = c.body;
    ++count[c.body];
  }
  EXPECT_GT(count[0], 0U);
  EXPECT_EQ(count[1], 0U);
  EXPECT_EQ(count[2], count[0]);
}

TEST(CellFinder, SaysWhatDidNotFit) {
  const box_pair pair;
  const cell_finder finder(pair.cells, 6e-4, 0.75);
  test::uniform_source random(5);
  // Two edges across each other, and their faces: all three lists have more than one entry.
  const pose T_wb;
  pose T_wa;
  near_cells all;
  do {
    T_wa = pair.touching(random, 2e-4, 3.0);
    ASSERT_EQ(finder.find({T_wa, std::span(&T_wb, 1)}, all), status::ok);
  } while (all.cells().size() < 4 || all.edges().size() < 2);
  std::size_t tiles = 0;
  for (const near_cell& c : all.cells()) tiles += c.count;
  for (const near_limits limits :
       {near_limits{all.cells().size() - 1, tiles, all.edges().size()},
        near_limits{all.cells().size(), tiles - 1, all.edges().size()},
        near_limits{all.cells().size(), tiles, all.edges().size() - 1}, near_limits{0, 0, 0}}) {
    near_cells small(limits);
    EXPECT_EQ(finder.find({T_wa, std::span(&T_wb, 1)}, small), status::capacity_reached);
    EXPECT_GT(small.dropped(), 0U);
    EXPECT_LE(small.cells().size(), limits.cells);
    EXPECT_LE(small.edges().size(), limits.edges);
    for (const near_cell& c : small.cells()) EXPECT_LE(c.first + c.count, limits.tiles);
    EXPECT_LE(small.size(), limits.readings());
  }
  near_cells enough({all.cells().size(), tiles, all.edges().size()});
  EXPECT_EQ(finder.find({T_wa, std::span(&T_wb, 1)}, enough), status::ok);
  EXPECT_EQ(enough.size(), all.size());
}

TEST(NearCells, ACellWithoutTilesIsForgotten) {
  near_cells near;
  EXPECT_TRUE(near.add_cell(0, false, 1));
  EXPECT_TRUE(near.add_cell(0, false, 2));
  near.add_tile(7);
  EXPECT_TRUE(near.add_cell(0, true, 3));
  near.close();
  ASSERT_EQ(near.cells().size(), 1U);
  EXPECT_EQ(near.cells()[0].cell, 2U);
  ASSERT_EQ(near.tiles(near.cells()[0]).size(), 1U);
  EXPECT_EQ(near.tiles(near.cells()[0])[0], 7U);
  near.clear();
  EXPECT_EQ(near.size(), 0U);
  EXPECT_EQ(near.dropped(), 0U);
}

}  // namespace
}  // namespace asperity
