// Ways out that turn as well: a face that rocks is let out, and the wrench is still minus the gradient of an energy.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>

#include "exit_lab.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr double half_m = 10.0 * mm;

exits::exit_rule turning() {
  exits::exit_rule rule;
  rule.turn_arm_m = 20.0 * mm;
  return rule;
}

field_body_ptr ground() {
  return make_formula_body({}, vec3(-20, -20, -30) * mm, vec3(20, 20, 20) * mm, 0.3 * mm,
                           [](const vec3& p) { return -p.z; });
}

// Largest change of the torque per angle while a box on a plane rocks from one edge to the other, N m / rad.
double steepest_torque(exit_lab& lab, double depth_m, const vec3& axis) {
  const double step_rad = 1e-4;
  double steepest = 0.0, before = 0.0;
  for (int i = -40; i <= 40; ++i) {
    const pose T{exp_rotation(i * step_rad * axis), vec3(0.0, 0.0, half_m - depth_m)};
    const double torque = glm::dot(lab.at(T).on_probe_w.torque, axis);
    if (i > -40) steepest = std::max(steepest, std::fabs(torque - before) / step_rad);
    before = torque;
  }
  return steepest;
}

TEST(TurningWaysOut, AFaceThatRocksIsLetOut) {
  drawing draw{std::mt19937_64(fresh_seed("TurningWaysOut.AFaceThatRocksIsLetOut", "2 depths, 6 at length"))};
  const field_body_ptr box = make_points_body(box_points(vec3(half_m), 12));
  exit_lab turns(box, {ground()}, turning()), shifts(box, {ground()});
  for (int i = 0; i < extent(2, 6); ++i) {
    const double depth = draw.between(0.1, 0.5) * mm, angle = draw.between(0.0, 6.3);
    const vec3 axis(std::cos(angle), std::sin(angle), 0.0);
    // The spring of the arm and the spread of a face of 20 mm, and what the spring's change by the pose adds.
    const double bound = 2.0 * 2000.0 * (0.02 * 0.02 + 8.0 * 2.0 * half_m * half_m / 3.0);
    EXPECT_LT(steepest_torque(turns, depth, axis), bound) << depth;
    // The control: translations are as stiff as the bed.
    EXPECT_GT(steepest_torque(shifts, depth, axis), 1.5 * steepest_torque(turns, depth, axis)) << depth;
  }
}

TEST(TurningWaysOut, AFlatContactKeepsItsSpring) {
  drawing draw{std::mt19937_64(fresh_seed("TurningWaysOut.AFlatContactKeepsItsSpring", "20 depths"))};
  exit_lab lab(make_points_body(box_points(vec3(half_m), 12)), {ground()}, turning());
  for (int i = 0; i < 20; ++i) {
    const double depth = draw.between(0.1, 4.0) * mm;
    const exit_answer a = lab.at(vec3(0.0, 0.0, half_m - depth));
    EXPECT_NEAR(a.on_probe_w.force.z, 2000.0 * depth, 2000.0 * (0.012 * depth + 2e-6));
  }
}

TEST(TurningWaysOut, TheWrenchIsMinusTheGradientOfTheEnergy) {
  drawing draw{std::mt19937_64(fresh_seed("TurningWaysOut.TheWrenchIsMinusTheGradient", "10 poses, 24 at length"))};
  const vec3 mass_centre_a(0.6 * mm, -0.4 * mm, 0.3 * mm);
  exit_lab lab(waved_box(vec3(7, 6, 5) * mm, 0.04 * mm, 0.4 * mm),
               {waved_box(vec3(12, 11, 6) * mm, 0.06 * mm, 0.7 * mm)}, turning(), mass_centre_a);
  const auto moved = [&](const pose& from, const vec3& by, const vec3& turned) {
    const quat rotation = exp_rotation(turned) * from.rotation;
    return pose{rotation, from * mass_centre_a + by - rotation * mass_centre_a};
  };
  int felt = 0;
  const int poses = extent(10, 24);
  for (int n = 0; n < poses; ++n) {
    const pose T{draw.rotation(), vec3(5, 5, 0) * mm * draw.vector() + vec3(0.0, 0.0, draw.between(11.0, 13.0) * mm)};
    const exit_answer a = lab.at(T);
    const double scale = glm::length(a.on_probe_w.force);
    if (a.hit.any() || a.deepest_m < 0.03 * mm) continue;
    ++felt;
    for (std::size_t i = 0; i < 6; ++i) {
      const auto energy = [&](double h) {
        vec6 step;
        step[i] = i < 3 ? h : 100.0 * h;
        return lab.at(moved(T, step.linear, step.angular)).energy_j;
      };
      const double h = 2e-7;
      const double slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
      const double reported = i < 3 ? to_vec6(a.on_probe_w)[i] : 100.0 * to_vec6(a.on_probe_w)[i];
      EXPECT_NEAR(reported, -slope, 1e-5 * scale) << "pose " << n << ", coordinate " << i;
    }
  }
  EXPECT_GT(felt, poses / 5);
}

}  // namespace
}  // namespace asperity
