// The parts of the law, each for itself.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "exit_lab.hpp"
#include "least_motion/eigen6.hpp"
#include "least_motion/mix.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using namespace test_support;
using namespace exits;

TEST(BedRule, PushAndRiseAreDerivativesOfTheEnergy) {
  const bed_rule bed{1e5, 15e-6};
  for (double depth = 1e-9; depth < 1e-2; depth *= 1.7) {
    const double h = 1e-4 * depth;
    EXPECT_NEAR((bed.energy_j(depth + h) - bed.energy_j(depth - h)) / (2.0 * h), bed.push_n(depth),
                1e-6 * bed.push_n(depth));
    EXPECT_NEAR((bed.push_n(depth + h) - bed.push_n(depth - h)) / (2.0 * h), bed.rise_n_per_m(depth),
                1e-6 * bed.rise_n_per_m(depth));
    EXPECT_LE(bed.rise_n_per_m(depth), 1e5);
  }
  EXPECT_EQ(bed.energy_j(0.0), 0.0);
}

TEST(EvenDirections, LeaveNoGap) {
  drawing draw{std::mt19937_64(fresh_seed("EvenDirections.LeaveNoGap", "2000 directions"))};
  const std::vector<vec3> all = even_directions(4);
  EXPECT_EQ(all.size(), 162U);
  for (int i = 0; i < 2000; ++i) {
    const vec3 d = glm::normalize(draw.vector());
    double nearest = 10.0;
    for (const vec3& u : all) nearest = std::min(nearest, std::acos(std::clamp(glm::dot(u, d), -1.0, 1.0)));
    EXPECT_LT(nearest, 12.0 * std::numbers::pi / 180.0);
  }
}

// What is taken away is positive, what stays is not, and the two have no direction in common.
TEST(NegativePart, TakesThePositiveDirectionsAway) {
  drawing draw{std::mt19937_64(fresh_seed("NegativePart.TakesThePositiveDirectionsAway", "200 matrices"))};
  for (int n = 0; n < 200; ++n) {
    mat6 a;
    const double length = 0.01;
    for (int k = 0; k < 6; ++k) {
      add_outer(a, draw.between(-2e3, 1e3), {draw.vector(), length * draw.vector()});
    }
    const mat6 low = negative_part(a, length), high = a - low;
    double product = 0.0, size = 0.0;
    for (int k = 0; k < 20; ++k) {
      const vec6 x{draw.vector(), draw.vector() / length};
      EXPECT_LE(dot(x, low * x), 1e-9);
      EXPECT_GE(dot(x, high * x), -1e-6);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 6; ++k) {
          const double per = k < 3 ? 1.0 : 1.0 / (length * length);
          sum += low(i, k) * per * high(k, j);
        }
        const double scale = (i < 3 ? 1.0 : 1.0 / length) * (j < 3 ? 1.0 : 1.0 / length);
        product = std::max(product, std::fabs(scale * sum));
        size = std::max(size, std::fabs(scale * a(i, j)));
        EXPECT_EQ(low(i, j), low(j, i));
      }
    }
    EXPECT_LT(product, 1e-9 * size * size);
  }
}

// At the least energy no way out with weight is dearer than another, and none without is cheaper.
TEST(Mix, LeavesNoCheaperWeights) {
  drawing draw{std::mt19937_64(fresh_seed("Mix.LeavesNoCheaperWeights", "3000 sets"))};
  const exit_springs k = exit_rule{}.springs();
  for (int n = 0; n < 3000; ++n) {
    ways_out ways;
    const int count = 1 + static_cast<int>(draw.between(0.0, 8.0));
    for (int i = 0; i < count; ++i) {
      way_out w;
      w.z_w = (1.0 + 0.1 * draw.between(-1.0, 1.0)) * mm * glm::normalize(draw.vector());
      w.bed.energy_j = 1e-5 * draw.between(0.0, 1.0);
      w.weight = i == 0 ? 1.0 : 0.0;
      ASSERT_TRUE(ways.push_back(w));
    }
    const double before = mixed_energy_j(ways, k);
    const vec3 y = mix(ways, k);
    EXPECT_LE(mixed_energy_j(ways, k), before * (1.0 + 1e-12));
    EXPECT_LT(glm::length(y - seen_from(ways, k)), 1e-15);
    double sum = 0.0, cheapest = 1e30, dearest = 0.0;
    for (const way_out& w : ways) {
      EXPECT_GE(w.weight, 0.0);
      sum += w.weight;
      cheapest = std::min(cheapest, w.cost_j(k, y));
      if (w.weight > 0.0) dearest = std::max(dearest, w.cost_j(k, y));
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
    EXPECT_LT(dearest - cheapest, 1e-8 * cheapest);
  }
}

TEST(LeastMotionOver, ClearsTheWallsOfACorner) {
  exit_planes planes;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 n(0.0);
    n[axis] = -1.0;
    static_cast<void>(planes.push_back({(axis + 1) * mm, n}));
  }
  const vec3 p = least_motion_over(planes, vec3(0.0), vec3(0.0), 50.0);
  // Each wall and the spring share its depth as 50 to 1.
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(p[axis], 50.0 / 51.0 * (axis + 1) * mm, 1e-9);
}

// The bottom of a notch is round in the field, and where the way out is longer than its radius the plane of one place
// swings about: with the present planes alone a descent does not come to rest, and most searches run out of readings.
TEST(Descend, ComesToRestInARoundNotch) {
  drawing draw{std::mt19937_64(fresh_seed("Descend.ComesToRestInARoundNotch", "40 grooves"))};
  std::vector<vec3> edge;
  for (int i = 0; i <= 200; ++i) edge.push_back(mm * vec3(0.0, -8.0 + 0.08 * i, 0.0));
  const field_body_ptr probe = make_points_body(edge);
  const pose T_wb;
  std::size_t most_readings = 0;
  int off = 0, inside = 0;
  for (int i = 0; i < 40; ++i) {
    const double half_rad = draw.between(0.7, 1.2);  // between wall and axis
    const vec3 left(std::cos(half_rad), 0.0, std::sin(half_rad)), right(-left.x, 0.0, left.z);
    const field_body_ptr groove =
        make_formula_body({}, vec3(-12.0 * mm), vec3(12.0 * mm), 0.5 * mm,
                          [&](const vec3& p) { return std::max(-glm::dot(left, p), -glm::dot(right, p)); });
    posed_samples samples(std::make_shared<const exit_scene>(field_scene{probe, {groove}}), vec3(0.0));
    const double depth_m = draw.between(0.3, 1.0) * mm;
    const pose T_wa{quat(1.0, 0.0, 0.0, 0.0), {draw.between(-0.2, 0.2) * mm, 0.0, -depth_m}};
    samples.place({T_wa, {&T_wb, 1}}, 10'000'000);
    mark m;
    ASSERT_TRUE(samples.deepest(vec3(0.0), 0.0, m));
    witnesses met;
    static_cast<void>(met.push_back(m));
    const vec3 z = descend(vec3(0.0), vec3(0.0), descent_rule{}, met, true, 1.0, {}, samples);
    most_readings = std::max(most_readings, samples.count.spent);
    // The nearest place of the edge on the groove's surface, by trying them all.
    double nearest_m = 1.0;
    for (double x = -0.4 * mm; x < 0.4 * mm; x += 0.01 * mm) {
      double low = -depth_m, high = 2.0 * mm;
      for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (low + high);
        (groove->field.coarse({x, 0.0, middle}).value_m > 0.0 ? low : high) = middle;
      }
      nearest_m = std::min(nearest_m, std::hypot(x - T_wa.position.x, low + depth_m));
    }
    off += std::fabs(glm::length(z) - nearest_m) > 0.03 * nearest_m ? 1 : 0;
    ASSERT_TRUE(samples.deepest(z, -1.0 * mm, m));
    inside += m.depth_m > 0.04 * nearest_m ? 1 : 0;
  }
  std::printf("  %d of 40 are off, %d inside; at most %zu readings\n", off, inside, most_readings);
  EXPECT_LE(off, 8);  // 20 where a descent knows its present planes alone
  EXPECT_LE(inside, 2);
}

// A descent that can only lead further than is of use ends; one that may go on finds the way out.
TEST(Descend, EndsWhereTheWayOutIsTooLong) {
  drawing draw{std::mt19937_64(fresh_seed("Descend.EndsWhereTheWayOutIsTooLong", "20 depths"))};
  const field_body_ptr ground =
      make_formula_body({}, vec3(-20.0 * mm), vec3(20.0 * mm), 0.3 * mm, [](const vec3& p) { return -p.z; });
  const field_body_ptr probe = make_points_body(sphere_points(10.0 * mm, 4000));
  posed_samples samples(std::make_shared<const exit_scene>(field_scene{probe, {ground}}), vec3(0.0));
  const pose T_wb;
  std::size_t saved = 0;
  for (int i = 0; i < 20; ++i) {
    const double depth = draw.between(2.0, 5.0) * mm;
    const quat rotation = draw.rotation();
    const auto spent = [&](double useful_m, vec3& z) {
      samples.place({{rotation, vec3(0.0, 0.0, 10.0 * mm - depth)}, {&T_wb, 1}}, 10'000'000);
      witnesses met;
      z = descend(vec3(0.0), vec3(0.0), {}, met, false, useful_m, {}, samples);
      return samples.count.spent;
    };
    vec3 whole, cut;
    const std::size_t all = spent(1.0, whole), some = spent(0.3 * depth, cut);
    EXPECT_NEAR(whole.z, depth, 0.05 * depth);
    saved += all > some ? all - some : 0;
    EXPECT_GT(glm::length(cut), 0.3 * depth);
  }
  EXPECT_GT(saved, 100U);
}

// The minimum of spring and bed on a half space: their forces are equal, and it is settled from any side.
TEST(Settle, BalancesSpringAndBed) {
  drawing draw{std::mt19937_64(fresh_seed("Settle.BalancesSpringAndBed", "50 starts"))};
  const field_body_ptr ground =
      make_formula_body({}, vec3(-20.0 * mm), vec3(20.0 * mm), 0.3 * mm, [](const vec3& p) { return -p.z; });
  const field_body_ptr probe = make_points_body(sphere_points(10.0 * mm, 4000));
  posed_samples samples(std::make_shared<const exit_scene>(field_scene{probe, {ground}}), vec3(0.0));
  const exit_rule rule;
  bed_patch patch(4000);
  const pose T_wb;
  for (int i = 0; i < 50; ++i) {
    const double depth = draw.between(0.1, 3.0) * mm;
    const pose T_wa{draw.rotation(), vec3(0.0, 0.0, 10.0 * mm - depth)};
    samples.place({T_wa, {&T_wb, 1}}, 10'000'000);
    patch.clear();
    const vec3 start = vec3(0.0, 0.0, depth) + 0.1 * mm * draw.vector();
    const way_out w = settle({2000.0, vec3(0.0), 0.2}, start, rule.bed_of_samples(), patch, samples);
    EXPECT_TRUE(w.settled);
    EXPECT_LT(glm::length(2000.0 * w.z_w + w.bed.gradient.linear), 1e-6 * 2000.0 * depth);
    EXPECT_NEAR(w.z_w.z, depth, 0.04 * depth + 10e-6);
    EXPECT_FALSE(w.touching.empty());
  }
}

}  // namespace
}  // namespace asperity
