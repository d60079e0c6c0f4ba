// The paper's contacts beyond their depth limit: the last valid direction is held, and the force goes on without a
// step.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "asperity/window/convex_piece_finder.hpp"
#include "asperity/window/window_renderer.hpp"
#include "contact_meter.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/random_hulls.hpp"

namespace asperity::contacts_test {
namespace {

/// A probe pressed into a fixed body, along a straight way with a slow turn, from a gap to the middle of that body.
struct press {
  std::string name;
  model_ptr probe, fixed;
  pose start;
  vec3 way_w{0.0};     ///< from the start to the end
  vec3 turn_rad{0.0};  ///< over the whole way

  [[nodiscard]] pose at(double share) const {
    return {glm::normalize(exp_rotation(share * turn_rad) * start.rotation), start.position + share * way_w};
  }
};

/// A press straight down or up to 10 degrees off, that begins anywhere on the middle half of the body's top.
press random_press(test::uniform_source& random, cut_into pieces) {
  model_plan plan;
  plan.pieces = pieces;
  const vec3 half_b = mm * vec3(random(12, 30), random(12, 30), random(8, 20));
  press out;
  if (random(0.0, 1.0) < 0.5) {
    const vec3 half_a = mm * vec3(random(3, 12), random(3, 12), random(6, 12));
    out.name = "box";
    out.probe = make_model(box(-half_a, half_a), plan);
    out.start.position.z = half_a.z;
  } else {
    const double radius = mm * random(6, 12);
    out.name = "roll";
    out.probe = make_model(prism(regular_polygon(24, radius), -mm * random(4, 12), mm * random(4, 12)), plan);
    out.start.position.z = radius;
  }
  out.fixed = make_model(box(-half_b, half_b), plan);
  const double tilt = random(0.0, 0.02);
  out.start.rotation = exp_rotation(tilt * random.direction()) * exp_rotation({0.0, 0.0, random(-3.0, 3.0)});
  out.start.position += vec3(0.5 * random(-half_b.x, half_b.x), 0.5 * random(-half_b.y, half_b.y), half_b.z + 0.5 * mm);
  const double down = half_b.z + 0.5 * mm;
  const double slope = std::tan(random(0.0, 0.17)), heading = random(-3.2, 3.2);
  out.way_w = down * vec3(slope * std::cos(heading), slope * std::sin(heading), -1.0);
  out.turn_rad = random(0.0, 0.05) * random.direction();
  return out;
}

/// What one way through felt like.
struct course {
  double largest_step_n = 0.0;       ///< of the force, from tick to tick
  double largest_held_step_n = 0.0;  ///< of these, where the contact is held, or was in the tick before
  double deepest_n = 0.0;            ///< force at the end of the way
  std::size_t held_ticks = 0;
  std::vector<double> bits;  ///< every number of every force
};

/// The paper's renderer with so soft a maximum that it does not see a ridge sweep over the samples.
window_renderer renderer_of(const press& p) {
  window_renderer_settings settings;
  settings.depth.tau_m = 0.1 * mm;
  return value_of(make_window_renderer({p.probe, {p.fixed}}, settings));
}

/// @param forgets  a new renderer for every pose, which has no direction to hold
/// @param back     and back again
course feel(const press& p, int ticks, bool forgets, bool back) {
  window_renderer r = renderer_of(p);
  course out;
  vec3 last(0.0);
  bool was_held = false;
  for (int i = 0; i <= (back ? 2 : 1) * ticks; ++i) {
    if (forgets) r = renderer_of(p);
    const double share = static_cast<double>(i <= ticks ? i : 2 * ticks - i) / ticks;
    const std::array<pose, 1> fixed{};
    tick felt;
    if (r.step({p.at(share), fixed}, felt) != status::ok) throw std::runtime_error("a step of the renderer failed");
    const vec3 force = felt.force.on_probe_w.force;
    bool held = false;
    for (const contact& c : felt.contacts) held = held || c.held;
    const double step = i > 0 ? glm::length(force - last) : 0.0;
    out.largest_step_n = std::max(out.largest_step_n, step);
    if (held || was_held) out.largest_held_step_n = std::max(out.largest_held_step_n, step);
    out.held_ticks += held ? 1U : 0U;
    if (i == ticks) out.deepest_n = glm::length(force);
    for (int k = 0; k < 3; ++k) out.bits.push_back(force[k]);
    last = force;
    was_held = held;
  }
  return out;
}

TEST(held_contact, the_force_does_not_step_from_the_touch_to_the_middle_of_the_body_and_back) {
  const std::uint64_t seed = test_support::fresh_seed("held_contact", "4 presses of 1000 ticks, 10 at length");
  constexpr int ticks = 500;
  for (std::uint64_t i = 0; i < test_support::extent<std::uint64_t>(4, 10); ++i) {
    SCOPED_TRACE(testing::Message() << "press " << i);
    test::uniform_source random(test_support::seed_of(seed, "press", i));
    const press p = random_press(random, i % 2 == 0 ? cut_into::whole : cut_into::triangles);
    const course c = feel(p, ticks, false, true);
    const double spring_n = stiffness_n_per_m * glm::length(p.way_w) / ticks;
    std::printf("  %s: steps up to %.3f N, %.3f N where held; a spring's %.3f N; %.1f N at the end\n", p.name.c_str(),
                c.largest_step_n, c.largest_held_step_n, spring_n, c.deepest_n);
    EXPECT_GT(c.held_ticks, 100U);
    EXPECT_LT(c.largest_held_step_n, 8.0 * spring_n);
    // At the touch a face comes up within a tick or two: the paper's contacts do.
    EXPECT_LT(c.largest_step_n, 0.1 * c.deepest_n);
    // The depth goes on growing to the end.
    EXPECT_GT(c.deepest_n, 0.8 * stiffness_n_per_m * -p.way_w.z);
  }
}

TEST(held_contact, without_a_history_the_force_falls_to_nothing_at_the_limit) {
  test::uniform_source random(test_support::seed_of(test_support::fresh_seed("forgotten", "2 presses"), "forgotten"));
  for (const cut_into pieces : {cut_into::whole, cut_into::triangles}) {
    const course c = feel(random_press(random, pieces), 60, true, false);
    EXPECT_EQ(c.held_ticks, 0U);
    EXPECT_GT(c.largest_step_n, 2.0);
    EXPECT_EQ(c.deepest_n, 0.0);
  }
}

TEST(held_contact, the_same_history_has_the_same_bits) {
  test::uniform_source random(test_support::seed_of(test_support::fresh_seed("bits", "2 presses, twice"), "bits"));
  for (const cut_into pieces : {cut_into::whole, cut_into::triangles}) {
    const press p = random_press(random, pieces);
    EXPECT_EQ(feel(p, 60, false, true).bits, feel(p, 60, false, true).bits);
  }
}

TEST(held_contact, is_let_go_outside_and_where_the_probe_is_put_elsewhere) {
  const scene bodies{make_model(block_mm(6, 5, 8), {}), {make_model(slab(), {})}};
  convex_piece_finder finder(bodies);
  contact_set found;
  const std::array<pose, 1> fixed{};
  const auto held_at = [&](const vec3& position_mm) {
    EXPECT_EQ(finder.find({pose_mm(position_mm), fixed}, found), status::ok);
    return found.size() == 1 && found.contacts().front().held;
  };
  const auto press_in = [&] {
    for (double z = 8.5; z > 3.0; z -= 0.25) static_cast<void>(held_at({0, 0, z}));
    return held_at({0, 0, 3});
  };
  ASSERT_TRUE(press_in());
  EXPECT_TRUE(held_at({1, 0, 3}));    // sideways inside
  EXPECT_FALSE(held_at({22, 0, 3}));  // inside, but further than across its window in one tick
  EXPECT_EQ(found.size(), 0U);

  ASSERT_FALSE(held_at({0, 0, 30}));
  ASSERT_TRUE(press_in());
  EXPECT_FALSE(held_at({200, 0, 3}));  // elsewhere
  EXPECT_EQ(found.size(), 0U);
  EXPECT_FALSE(held_at({0, 0, 3}));  // and back: deep, with no direction that was ever valid
  EXPECT_EQ(found.size(), 0U);

  ASSERT_FALSE(held_at({0, 0, 30}));
  ASSERT_TRUE(press_in());
  for (double z = 3.0; z > -18.0; z -= 0.25) EXPECT_TRUE(held_at({0, 0, z})) << z;
  EXPECT_FALSE(held_at({0, 0, -18.5}));  // out at the lower side: the slab is 10 mm thick, the block 16 mm high
  EXPECT_EQ(found.size(), 0U);

  ASSERT_FALSE(held_at({0, 0, 30}));
  ASSERT_TRUE(press_in());
  for (double x = 0.0; x < 36.0; x += 0.25) static_cast<void>(held_at({x, 0, 3}));
  EXPECT_FALSE(held_at({37, 0, 3}));  // out at the side
  EXPECT_EQ(found.size(), 0U);
}

}  // namespace
}  // namespace asperity::contacts_test
