// Samples against relief maps, from both sides: what is read, and how it changes with the pose.
#include "asperity/depth/cell_depth.hpp"

#include <gtest/gtest.h>

#include "asperity/collision/cell_finder.hpp"
#include "support/box_pairs.hpp"
#include "support/motion.hpp"

namespace asperity {
namespace {

using test_support::box_pair;
using test_support::derivative;
using test_support::displaced;
using test_support::everything;
using test_support::largest;

constexpr double tau = 3e-5, lever = 0.005;

shared_settings with_tau() {
  shared_settings s;
  s.tau_m = tau;
  return s;
}

struct bench {
  box_pair pair;
  cell_depth depth;
  cell_finder finder;
  pose T_wb;

  explicit bench(double relief_m = 1e-4)
      : pair(relief_m),
        depth(pair.cells, pair.bodies, with_tau()),
        finder(pair.cells, cell_depth::reach_m(with_tau()), with_tau().facing_none) {}

  [[nodiscard]] scene_pose at(const pose& T_wa) const { return {T_wa, std::span(&T_wb, 1)}; }
  [[nodiscard]] near_cells near(const pose& T_wa) const {
    near_cells out;
    EXPECT_EQ(finder.find(at(T_wa), out), status::ok);
    return out;
  }
  [[nodiscard]] std::vector<cell_reading> read(const pose& T_wa, const near_cells& near) const {
    std::vector<cell_reading> out(near.size());
    EXPECT_EQ(depth.measure(at(T_wa), near, out), status::ok);
    return out;
  }
};

/// The readings of the probe's lower face and the fixed body's upper one, each met by the other's samples.
struct two_sides {
  cell_reading on_probe, on_fixed;
  two_sides(const bench& b, const pose& T_wa) {
    const near_cells near = b.near(T_wa);
    const auto readings = b.read(T_wa, near);
    for (std::size_t i = 0; i < near.cells().size(); ++i) {
      const near_cell& c = near.cells()[i];
      const surface_cells& body = c.on_probe ? *b.pair.cells->probe : *b.pair.cells->fixed[0];
      if (std::fabs(body.cells[c.cell].n_b.z) < 0.9 || readings[i].samples == 0) continue;
      (c.on_probe ? on_probe : on_fixed) = readings[i];
    }
  }
};

TEST(CellDepth, FlatOnFlatIsReadTheSameFromBothSides) {
  const bench b(0.0);
  for (const double depth : {-1e-4, 1e-5, 3e-4}) {
    const pose T{quat(0, 1, 0, 0), {0.0, 0.0, 0.011 - depth}};
    const two_sides side(b, T);
    for (const cell_reading& r : {side.on_probe, side.on_fixed}) {
      ASSERT_GT(r.samples, 0U);
      EXPECT_LT(glm::distance(r.n_ab_w, vec3(0, 0, -1)), 1e-12);
      EXPECT_NEAR(r.depth_m, depth, 2e-3 * std::fabs(depth) + 1e-8);
      EXPECT_NEAR(r.moment / r.mass, depth, 0.5 * tau);
      EXPECT_LT(glm::length(vec2(r.centre_w)), 2e-4);
      EXPECT_NEAR(r.centre_w.z, 0.006, std::fabs(depth) + 1e-6);
      // Of a rectangle with half sides of 6 and 4 mm, less what the taper takes off its rim.
      EXPECT_NEAR(r.spread_m, std::sqrt((36e-6 + 16e-6) / 3.0), 1e-3);
      EXPECT_FALSE(r.too_deep);
      EXPECT_EQ(r.overlap > 0.0, depth > 0.0);
      EXPECT_EQ(r.area_m2 > 0.0, depth > 0.0);
    }
    EXPECT_NEAR(side.on_probe.depth_m, side.on_fixed.depth_m, 1e-3 * std::fabs(depth) + 1e-8);
    if (depth <= 0.0) continue;
    // The fixed face's map is met by the whole of the probe's face, its edges and its corners.
    const double pitch = b.pair.cells->probe->settings.feature_pitch_m;
    const double area = 4.0 * 0.006 * 0.004 + 4.0 * (0.006 + 0.004) * pitch + 4.0 * pitch * pitch;
    EXPECT_NEAR(side.on_fixed.area_m2, area, 0.02 * area);
    // Straight down it gets deeper as fast as it moves.
    EXPECT_NEAR(side.on_fixed.slope_sum.linear.z / side.on_fixed.mass, -1.0, 0.04);
    EXPECT_NEAR(side.on_probe.slope_sum.linear.z / side.on_probe.mass, -1.0, 0.04);
  }
}

TEST(CellDepth, ReliefCountsOnBothBodies) {
  const bench b(1e-4);  // ridges of 0.1 mm across x, upwards at x = 1 mm on either
  const pose T{quat(0, 1, 0, 0), {0.0, 0.0, 0.0111}};
  const two_sides peak_on_peak(b, T), peak_in_valley(b, {T.rotation, T.position + vec3(2e-3, 0, 0)});
  for (const auto& side : {&two_sides::on_probe, &two_sides::on_fixed}) {
    EXPECT_NEAR((peak_on_peak.*side).depth_m, 1e-4, 1e-5);
    // On the faces the reliefs cancel; an edge lies halfway between its two faces' reliefs, and comes nearer.
    EXPECT_NEAR((peak_in_valley.*side).depth_m, -0.75e-4, 0.3e-4);
  }
}

TEST(CellDepth, TooDeepIsSaid) {
  const bench b(0.0);
  const two_sides firm(b, {quat(0, 1, 0, 0), {0.0, 0.0, 0.011 - 0.9e-3}});
  EXPECT_FALSE(firm.on_fixed.too_deep);
  const pose T{quat(0, 1, 0, 0), {0.0, 0.0, 0.011 - 1.1e-3}};
  const near_cells near = b.near(T);
  bool said = false;
  for (const cell_reading& r : b.read(T, near)) said = said || r.too_deep;
  EXPECT_TRUE(said);
}

TEST(CellDepth, RefusesTooFewReadingsAndOtherBodies) {
  const bench b;
  const near_cells all = everything(*b.pair.cells);
  std::vector<cell_reading> few(all.size() - 1), enough(all.size());
  const pose T{quat(0, 1, 0, 0), {0.0, 0.0, 0.02}};
  EXPECT_EQ(b.depth.measure(b.at(T), all, few), status::not_ready);
  EXPECT_EQ(b.depth.measure({T, {}}, all, enough), status::not_ready);
  EXPECT_EQ(b.depth.measure(b.at(T), all, enough), status::ok);
}

TEST(CellDepth, FarFromEverythingIsNothing) {
  const bench b;
  const near_cells all = everything(*b.pair.cells);
  for (const cell_reading& r : b.read({{}, {1.0, 2.0, 3.0}}, all)) {
    EXPECT_EQ(r.samples, 0U);
    EXPECT_EQ(r.mass, 0.0);
  }
}

/// Numbers of a reading that have a slope, at a fixed reference.
double number(const cell_reading& r, int which, double reference) {
  const double s = r.samples == 0 ? 0.0 : std::exp((r.reference_m - reference) / tau);
  return which == 0 ? s * r.mass : (which == 1 ? s * r.moment : r.overlap);
}

TEST(CellDepth, SlopesAreTheDerivativesThroughAllFades) {
  const bench b;
  test::uniform_source random(1);
  int readings = 0, from_probe = 0, slanted = 0, shallow = 0, deep = 0, outside = 0;
  double worst = 0.0;
  for (int n = 0; n < 120; ++n) {
    const pose T =
        b.pair.touching(random, random(-3.0 * tau, n % 2 == 0 ? 3.0 * tau : 1.05e-3), n % 3 == 0 ? 3.0 : 0.5);
    const vec3 c_w = T * b.pair.bodies.probe->mass.centre_of_mass;
    const near_cells near = b.near(T);
    const auto here = b.read(T, near);
    constexpr double step = 2e-9;
    std::array<std::vector<cell_reading>, 12> there;
    for (std::size_t i = 0; i < 12; ++i) {
      vec6 q;
      q[i / 2] = (i % 2 == 0 ? step : -step) / (i < 6 ? 1.0 : lever);
      there[i] = b.read(displaced(T, c_w, q), near);
    }
    for (std::size_t r = 0; r < near.cells().size(); ++r) {
      const cell_reading& x = here[r];
      if (x.samples == 0 || x.mass < 1e-14) continue;
      const near_cell& cell = near.cells()[r];
      ++readings;
      from_probe += cell.on_probe ? 1 : 0;
      outside += x.depth_m < 0.0 ? 1 : 0;
      shallow += x.depth_m > 0.0 && x.depth_m < 2.0 * tau ? 1 : 0;
      deep += x.too_deep || x.depth_m > 0.5e-3 ? 1 : 0;
      const surface_cells& other = cell.on_probe ? *b.pair.cells->fixed[0] : *b.pair.cells->probe;
      for (const surface_cell& o : other.cells) {
        const vec3 n_w = cell.on_probe ? o.n_b : -(T.rotation * o.n_b);
        const double cosine = -glm::dot(n_w, x.n_ab_w);
        slanted += cosine > 0.76 && cosine < 0.91 ? 1 : 0;
      }
      const vec6 given[3] = {x.mass_slope, x.moment_slope, x.overlap_slope};
      for (int which = 0; which < 3; ++which) {
        vec6 expected;
        for (std::size_t i = 0; i < 6; ++i) {
          expected[i] =
              (number(there[2 * i][r], which, x.reference_m) - number(there[2 * i + 1][r], which, x.reference_m)) /
              (2.0 * step / (i < 3 ? 1.0 : lever));
        }
        const double size = std::max(largest(expected, lever), std::fabs(number(x, which, x.reference_m)) / tau);
        const double error = size > 0.0 ? largest(given[which] - expected, lever) / size : 0.0;
        worst = std::max(worst, error);
        EXPECT_LT(error, 2e-5) << "number " << which << ", depth " << x.depth_m;
      }
      for (int k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) {
          const double expected =
              (there[6 + 2 * i][r].n_ab_w[k] - there[7 + 2 * i][r].n_ab_w[k]) / (2.0 * step / lever);
          EXPECT_NEAR(x.turn[static_cast<int>(i)][k], expected, 1e-6);
        }
      }
    }
  }
  std::printf(
      "%d readings, worst error of a slope %.1g; %d on the probe, %d at a slant, %d shallow, %d deep, %d outside\n",
      readings, worst, from_probe, slanted, shallow, deep, outside);
  for (const int count : {from_probe, slanted, shallow, deep, outside}) EXPECT_GE(count, 15);
  EXPECT_GE(readings - from_probe, 15);
}

TEST(CellDepth, SlopeProductIsASpreadOfSlopes) {
  const bench b;
  test::uniform_source random(2);
  int readings = 0;
  for (int n = 0; n < 20; ++n) {
    const pose T = b.pair.touching(random, 3e-4, 0.3);
    const near_cells near = b.near(T);
    for (const cell_reading& r : b.read(T, near)) {
      if (r.samples == 0) continue;
      ++readings;
      mat6 spread = (1.0 / r.mass) * r.slope_product;
      add_outer(spread, -1.0 / (r.mass * r.mass), r.slope_sum);
      double trace = 0.0;
      for (std::size_t i = 0; i < 6; ++i) trace += r.slope_product(i, i) / r.mass;
      for (int k = 0; k < 20; ++k) {
        const vec6 v{random.in_box(1.0), random.in_box(1.0)};
        EXPECT_GE(dot(v, spread * v), -1e-9 * trace);
      }
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < i; ++j) EXPECT_EQ(r.slope_product(i, j), r.slope_product(j, i));
      }
    }
  }
  EXPECT_GE(readings, 20);
}

}  // namespace
}  // namespace asperity
