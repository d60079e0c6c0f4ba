// What the plane renderer tells of presses that its planes do not answer: poses that go through bodies, whatever holds
// or does not hold the probe there, and poses of ordinary sessions, in which nothing is told.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "asperity/planes/plane_renderer.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

const vec3 probe_half(0.004, 0.003, 0.002), plate_half(0.015, 0.015, 0.0005), block_half(0.012, 0.011, 0.01);

/// A small box as the probe, and a plate of 1 mm with a block beside it as fixed bodies.
const scene& bodies() {
  static const scene made{std::make_shared<const textured_model>(make_flat_box(probe_half, 128)),
                          {std::make_shared<const textured_model>(make_flat_box(plate_half, 256)),
                           std::make_shared<const textured_model>(make_flat_box(block_half, 256))}};
  return made;
}

plane_renderer make_boxes() {
  static const auto fields = std::make_shared<const field_scene>(make_field_scene(bodies()).value());
  return make_plane_renderer(bodies(), fields).value();
}

struct drawn_pose {
  std::mt19937_64 bits;
  double unit() { return std::uniform_real_distribution<double>(-1.0, 1.0)(bits); }
  double between(double low, double high) { return low + 0.5 * (1.0 + unit()) * (high - low); }
  vec3 vector() { return {unit(), unit(), unit()}; }
  quat rotation() { return glm::normalize(quat(unit(), unit(), unit(), unit())); }
  vec3 direction() { return glm::normalize(vec3(unit(), unit(), unit()) + vec3(1e-9)); }
};

/// From the probe's centre to its lowest corner, when it is turned.
vec3 lowest_corner(const quat& rotation) {
  vec3 lowest(1e30);
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    const vec3 at = rotation * (sign * probe_half);
    if (at.z < lowest.z) lowest = at;
  }
  return lowest;
}

/// The fixed bodies somewhere in the world, 60 mm apart.
std::vector<pose> placed(drawn_pose& draw) {
  const pose where{draw.rotation(), 0.2 * draw.vector()};
  return {where, where * pose{quat(1, 0, 0, 0), {0.06, 0, 0}}};
}

/// Far away, so that what comes is no motion from what was.
void leave(plane_renderer& feel, const std::vector<pose>& T_wb) {
  tick away;
  EXPECT_EQ(feel.step({T_wb[0] * pose{quat(1, 0, 0, 0), {0, 0, 1}}, T_wb}, away), status::ok);
}

struct reported {
  std::size_t beyond_field = 0, passed = 0, not_held = 0;
  double passed_at_m = 0.0;  ///< depth of the probe's lowest corner below the face when it was told

  void add(tick_flag f, double depth_m) {
    beyond_field += has(f, tick_flag::beyond_field) ? 1U : 0U;
    not_held += has(f, tick_flag::not_held) ? 1U : 0U;
    if (!has(f, tick_flag::passed)) return;
    if (passed == 0) passed_at_m = depth_m;
    ++passed;
  }
};

/// A corner of the probe goes straight down on the middle of the upper face of body b to `depth_m` and back, in steps
/// of step_m.
reported press(plane_renderer& feel, drawn_pose& draw, std::size_t b, double depth_m, double step_m) {
  const std::vector<pose> T_wb = placed(draw);
  const double face = (b == 0 ? plate_half : block_half).z;
  const quat rotation = draw.rotation();
  const vec3 at = vec3(5e-4 * draw.unit(), 5e-4 * draw.unit(), face) - lowest_corner(rotation);
  reported out;
  const auto look = [&](double d) {
    const pose T_wa = T_wb[b] * pose{rotation, at - vec3(0, 0, d)};
    tick t;
    EXPECT_EQ(feel.step({T_wa, T_wb}, t), status::ok);
    out.add(t.flags, d);
  };
  leave(feel, T_wb);
  double d = -5e-4 * draw.between(0.1, 1.0);
  for (; d < depth_m; d += step_m) look(d);
  for (d = depth_m; d > -1e-3; d -= step_m) look(d);
  return out;
}

// As deep as planes let 20 N press: neither on the thin plate nor on the block is anything told.
TEST(plane_watch, is_silent_in_ordinary_presses) {
  drawn_pose draw{std::mt19937_64(fresh_seed("plane_watch.is_silent_in_ordinary_presses", "12 presses, 30 at length"))};
  plane_renderer feel = make_boxes();
  for (int n = 0; n < extent(12, 30); ++n) {
    const double depth = draw.between(5e-5, n % 2 == 0 ? 3e-4 : 4e-4), step = draw.between(1e-5, 1e-4);
    const reported t = press(feel, draw, static_cast<std::size_t>(n % 2), depth, step);
    EXPECT_EQ(t.beyond_field + t.passed + t.not_held, 0U) << n << ": depth " << depth << " step " << step;
  }
}

// Through the plate at up to 4 m/s, in ticks of a millisecond: told, and not before it is half way.
TEST(plane_watch, reports_every_passage_of_a_plate) {
  drawn_pose draw{
      std::mt19937_64(fresh_seed("plane_watch.reports_every_passage_of_a_plate", "12 presses, 30 at length"))};
  plane_renderer feel = make_boxes();
  for (int n = 0; n < extent(12, 30); ++n) {
    const double step = 2e-5 * std::pow(200.0, draw.between(0.0, 1.0));
    const reported t = press(feel, draw, 0, 1.6e-3 + 2.0 * step, step);
    EXPECT_GE(t.passed, 1U) << n << ": step " << step;
    EXPECT_GT(t.passed_at_m, plate_half.z) << n;
    EXPECT_LT(t.passed_at_m, 2.1 * plate_half.z + step) << n << ": step " << step;
    if (step < 1e-4) {
      EXPECT_GE(t.beyond_field, 1U) << n << ": step " << step;
    }
  }
}

// Into the block: not held from a millimetre on, beyond its field near the middle, passed behind it.
TEST(plane_watch, reports_how_deep_a_block_was_left) {
  drawn_pose draw{
      std::mt19937_64(fresh_seed("plane_watch.reports_how_deep_a_block_was_left", "3 presses, 8 at length"))};
  plane_renderer feel = make_boxes();
  for (int n = 0; n < extent(3, 8); ++n) {
    const double step = draw.between(1e-4, 1e-3);
    const reported shallow = press(feel, draw, 1, 5e-4, 1e-4);
    EXPECT_EQ(shallow.not_held + shallow.beyond_field + shallow.passed, 0U);
    const reported deep = press(feel, draw, 1, 3e-3, step);
    EXPECT_GE(deep.not_held, 1U);
    const reported through = press(feel, draw, 1, 0.014, step);
    EXPECT_GE(through.beyond_field, 1U);
    EXPECT_GE(through.passed, 1U);
    EXPECT_GT(through.passed_at_m, 0.8 * probe_half.z);  // the block's face is through half of the probe before
  }
}

// A probe that is led round the plate's rim, 0.1 mm deep, is on the other side and has not passed.
TEST(plane_watch, is_silent_round_a_rim) {
  drawn_pose draw{std::mt19937_64(fresh_seed("plane_watch.is_silent_round_a_rim", "2 ways, 6 at length"))};
  plane_renderer feel = make_boxes();
  for (int n = 0; n < extent(2, 6); ++n) {
    const std::vector<pose> T_wb = placed(draw);
    const double depth = draw.between(2e-5, 1e-4), y = 0.008 * draw.unit();
    // A ball's way would be a stadium; a box that keeps its attitude goes along three sides.
    const double x = plate_half.x + probe_half.x - depth, z = plate_half.z + probe_half.z - depth;
    std::vector<vec3> corners{{x - 0.004, y, z}, {x, y, z}, {x, y, -z}, {x - 0.004, y, -z}};
    reported t;
    leave(feel, T_wb);
    for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
      for (double s = 0.0; s < 1.0; s += 0.01) {
        const vec3 at = (1.0 - s) * corners[c] + s * corners[c + 1];
        tick found;
        EXPECT_EQ(feel.step({T_wb[0] * pose{quat(1, 0, 0, 0), at}, T_wb}, found), status::ok);
        t.add(found.flags, 0.0);
      }
    }
    EXPECT_EQ(t.passed + t.not_held + t.beyond_field, 0U) << n << ": depth " << depth;
  }
}

// Poses that have nothing to do with each other are no passage.
TEST(plane_watch, is_silent_between_unrelated_poses) {
  drawn_pose draw{std::mt19937_64(fresh_seed("plane_watch.is_silent_between_unrelated_poses", "30 pairs"))};
  plane_renderer feel = make_boxes();
  for (int n = 0; n < 30; ++n) {
    const std::vector<pose> T_wb = placed(draw);
    const quat rotation = draw.rotation();
    const double z = plate_half.z - lowest_corner(rotation).z - 1e-4;
    tick t;
    EXPECT_EQ(feel.step({T_wb[0] * pose{rotation, {0, 0, z}}, T_wb}, t), status::ok);
    EXPECT_EQ(feel.step({T_wb[0] * pose{rotation, {0, 0, z - draw.between(0.012, 0.03)}}, T_wb}, t), status::ok);
    EXPECT_FALSE(has(t.flags, tick_flag::passed)) << n;
  }
}

}  // namespace
}  // namespace asperity
