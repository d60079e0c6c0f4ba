// The default renderer, from end to end.
#include "asperity/least_motion/least_motion_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "least_motion/exit_scene.hpp"
#include "least_motion/exit_solver.hpp"
#include "support/counted_news.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

const vec3 small_half(0.006, 0.005, 0.004), large_half(0.03, 0.03, 0.01);

scene box_over_box() {
  static const auto small = std::make_shared<const textured_model>(make_flat_box(small_half, 192));
  static const auto large = std::make_shared<const textured_model>(make_flat_box(large_half, 384));
  return {small, {large}};
}

std::shared_ptr<const field_scene> fields_once() {
  static const auto made = std::make_shared<const field_scene>(make_field_scene(box_over_box()).value());
  return made;
}

least_motion_renderer make_boxes(const least_motion_renderer_settings& settings = {}) {
  return make_least_motion_renderer(box_over_box(), fields_once(), settings).value();
}

struct pose_drawing {
  std::mt19937_64 bits;
  double unit() { return std::uniform_real_distribution<double>(-1.0, 1.0)(bits); }
  vec3 vector() { return {unit(), unit(), unit()}; }
  quat rotation() { return glm::normalize(quat(unit(), unit(), unit(), unit())); }
};

// A box with a corner, an edge or a face down, this deep in the upper face of the large box.
pose lowered_box(pose_drawing& draw, double depth_m) {
  pose T_wa{draw.rotation(), {0.01 * draw.unit(), 0.01 * draw.unit(), 0.0}};
  double lowest = 1e30;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    lowest = std::min(lowest, (T_wa * (sign * small_half)).z);
  }
  T_wa.position.z = large_half.z - depth_m - lowest;
  return T_wa;
}

TEST(DefaultRenderer, PushesByItsStiffnessAtAnyDepth) {
  pose_drawing draw{std::mt19937_64(fresh_seed("DefaultRenderer.PushesByItsStiffnessAtAnyDepth", "100 poses"))};
  least_motion_renderer feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  const double k = feel.force().settings().stiffness_n_per_m, soft = feel.force().settings().softness_m;
  tick t;
  for (int n = 0; n < 100; ++n) {
    const double depth = 3e-3 * (1.0 + draw.unit());
    ASSERT_EQ(feel.step({lowered_box(draw, depth), T_wb}, t), status::ok);
    // A corner beside the middle of where the bodies are close is let out by a turn as well: 2 % softer here.
    EXPECT_NEAR(t.force.on_probe_w.force.z, k * depth, k * (0.03 * depth + soft + 4e-6)) << "pose " << n;
    ASSERT_FALSE(t.contacts.empty());
    EXPECT_GT(glm::dot(t.contacts[0].window.n_ab_w, vec3(0.0, 0.0, -1.0)), 0.99);
    EXPECT_NEAR(t.depths[0].depth_m, depth, 0.03 * depth + 2.0 * soft + 4e-6);
    EXPECT_EQ(t.contacts[0].body, 0U);
    EXPECT_TRUE(t.planes.empty());
  }
}

TEST(DefaultRenderer, FeelsNothingWhereNothingOverlaps) {
  pose_drawing draw{std::mt19937_64(fresh_seed("DefaultRenderer.FeelsNothing", "100 poses"))};
  least_motion_renderer feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  tick t;
  for (int n = 0; n < 100; ++n) {
    ASSERT_EQ(feel.step({lowered_box(draw, -1e-5 - 1e-3 * (1.0 + draw.unit())), T_wb}, t), status::ok);
    EXPECT_EQ(t.force.on_probe_w.force, vec3(0.0));
    EXPECT_EQ(t.force.on_probe_w.torque, vec3(0.0));
    EXPECT_TRUE(t.contacts.empty());
  }
}

// The wrench does not change where all bodies are carried elsewhere, but for being carried along.
TEST(DefaultRenderer, TheWorldDoesNotMatter) {
  pose_drawing draw{std::mt19937_64(fresh_seed("DefaultRenderer.TheWorldDoesNotMatter", "20 poses"))};
  least_motion_renderer feel = make_boxes();
  tick t;
  for (int n = 0; n < 20; ++n) {
    const pose T_wa = lowered_box(draw, 1e-3);
    std::vector<pose> T_wb{pose{}};
    ASSERT_EQ(feel.step({T_wa, T_wb}, t), status::ok);
    const vec3 here = t.force.on_probe_w.force, torque = t.force.on_probe_w.torque;
    const pose carried{draw.rotation(), 0.2 * draw.vector()};
    T_wb[0] = carried;
    ASSERT_EQ(feel.step({carried * T_wa, T_wb}, t), status::ok);
    EXPECT_LT(glm::length(t.force.on_probe_w.force - carried.rotation * here), 1e-5 * glm::length(here));
    EXPECT_LT(glm::length(t.force.on_probe_w.torque - carried.rotation * torque), 1e-7 * glm::length(here));
  }
}

TEST(DefaultRenderer, TellsPlanesWhereAskedTo) {
  least_motion_renderer_settings settings;
  settings.reach_m = 1e-3;
  least_motion_renderer feel = make_boxes(settings);
  const std::vector<pose> T_wb{pose{}};
  tick t;
  ASSERT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, 0.0145}}, T_wb}, t), status::ok);
  EXPECT_FALSE(t.planes.empty());
  EXPECT_EQ(t.force.on_probe_w.force, vec3(0.0));
}

TEST(DefaultRenderer, SaysWhenItsReadingsAreSpent) {
  pose_drawing draw{std::mt19937_64(fresh_seed("DefaultRenderer.SaysWhenItsReadingsAreSpent", "20 poses"))};
  least_motion_renderer_settings settings;
  settings.force.most_readings = 1000;
  least_motion_renderer feel = make_boxes(settings);
  const std::vector<pose> T_wb{pose{}};
  tick t;
  int reported = 0;
  for (int n = 0; n < 20; ++n) {
    const status s = feel.step({lowered_box(draw, 4e-3), T_wb}, t);
    EXPECT_TRUE(s == status::ok || s == status::capacity_reached);
    EXPECT_EQ(s == status::capacity_reached, feel.force().hit().any());
    EXPECT_TRUE(is_finite(t.force.on_probe_w));
    if (s == status::capacity_reached) {
      ++reported;
      for (const penetration& d : t.depths) EXPECT_TRUE(has(d.flags, depth_flag::unresolved));
    }
  }
  EXPECT_GT(reported, 5);
}

TEST(DefaultRenderer, AllocatesNothingInATick) {
  pose_drawing draw{std::mt19937_64(fresh_seed("DefaultRenderer.AllocatesNothingInATick", "50 poses"))};
  least_motion_renderer feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  std::vector<pose> at;
  for (int n = 0; n < 50; ++n) at.push_back(lowered_box(draw, 3e-3 * draw.unit()));
  tick t;
  const std::size_t before = news_in_this_thread();
  bool usable = true;
  for (const pose& T_wa : at) usable = feel.step({T_wa, T_wb}, t) == status::ok && usable;
  EXPECT_EQ(news_in_this_thread(), before);
  EXPECT_TRUE(usable);
}

// Under a micrometre the rounding of places hides what a step of the search gains; it has to end all the same.
TEST(DefaultRenderer, ALightTouchSettles) {
  pose_drawing draw{std::mt19937_64(fresh_seed("DefaultRenderer.ALightTouchSettles", "400 poses"))};
  auto feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  tick t;
  int felt = 0;
  for (int n = 0; n < 400; ++n) {
    const double depth = 1e-6 * std::exp(2.0 * draw.unit());  // 0.14 to 7 um
    EXPECT_EQ(feel.step({lowered_box(draw, depth), T_wb}, t), status::ok) << "pose " << n << ", " << depth << " m";
    felt += t.force.on_probe_w.force.z > 0.0 ? 1 : 0;
  }
  EXPECT_GT(felt, 200);
}

TEST(DefaultRenderer, RefusesSettingsOutOfRange) {
  const auto refuses = [](auto change) {
    least_motion_renderer_settings s;
    change(s);
    const auto made = make_least_motion_renderer(box_over_box(), fields_once(), s);
    return !made && made.error().code == error_code::invalid_argument;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([](auto& s) { s.force.stiffness_n_per_m = 0.0; }));
  EXPECT_TRUE(refuses([&](auto& s) { s.force.softness_m = nan; }));
  EXPECT_TRUE(refuses([](auto& s) { s.force.softness_m = -1e-6; }));
  EXPECT_TRUE(refuses([](auto& s) { s.force.sharpness = 1.5; }));
  EXPECT_TRUE(refuses([](auto& s) { s.force.period_s = 0.0; }));
  EXPECT_TRUE(refuses([](auto& s) { s.force.most_readings = 10; }));
  EXPECT_TRUE(refuses([](auto& s) { s.force.most_samples = 1; }));
  EXPECT_TRUE(refuses([](auto& s) { s.reach_m = -1.0; }));
  EXPECT_FALSE(refuses([](auto&) {}));
  EXPECT_FALSE(make_renderer(scene{box_over_box().probe, {}}));
  EXPECT_FALSE(make_least_motion_renderer(box_over_box(), nullptr));
}

// A quicker loop can follow a sharper contact; no softness blurs a texel.
TEST(DefaultRenderer, SoftnessFollowsTheLoop) {
  const contact_softness slow = softness_for(1e-3, 1e-3), fast = softness_for(1e-4, 1e-3),
                         fine = softness_for(1e-3, 2e-5);
  EXPECT_NEAR(slow.softness_m, 15e-6, 1e-9);
  EXPECT_NEAR(slow.sharpness, 4.0, 1e-9);
  EXPECT_LT(fast.softness_m, 0.2 * slow.softness_m);
  EXPECT_GT(fast.sharpness, 2.5 * slow.sharpness);
  EXPECT_NEAR(fine.softness_m, 5e-6, 1e-9);
  least_motion_renderer_settings settings;
  settings.force.period_s = 1e-4;
  EXPECT_LT(make_boxes(settings).force().settings().softness_m, make_boxes().force().settings().softness_m);
}

TEST(DefaultRenderer, CountsItsMemory) {
  least_motion_renderer feel = make_boxes();
  const std::size_t fields = fields_once()->heap_bytes();
  EXPECT_GT(feel.memory_bytes(), fields + feel.force().settings().most_samples * sizeof(exits::mark));
  EXPECT_LT(feel.memory_bytes(), 4 * fields + 20'000'000U);
}

}  // namespace
}  // namespace asperity
