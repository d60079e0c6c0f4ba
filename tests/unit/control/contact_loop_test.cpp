#include <array>
#include <gtest/gtest.h>
#include <limits>

#include <asperity/control/contact_loop.hpp>

#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

struct contact_loop_test : testing::Test {
  exchange shared;
  void put(const pose& T_wc, std::int64_t time_ns) {
    shared.poses.back() = {T_wc, time_ns};
    shared.poses.publish();
  }
};

TEST_F(contact_loop_test, waits_for_a_first_pose) {
  contact_loop<analytic_wall> loop({}, {{pose{}}, vec3(0.0)}, shared);
  EXPECT_EQ(loop.tick(0), status::ok);
  EXPECT_EQ(loop.computed(), 0U);
  EXPECT_FALSE(shared.contacts.refresh());
}

TEST_F(contact_loop_test, publishes_wrench_stiffness_pose_and_the_time_of_the_pose) {
  analytic_wall wall;
  wall.centre_of_mass_a = {0.01, 0.0, 0.02};
  contact_loop<analytic_wall> loop(wall, {{pose{}}, wall.centre_of_mass_a}, shared);
  const pose T_wc{exp_rotation({0, 0, 0.4}), {0.3, 0.1, -0.001}};
  put(T_wc, 42);
  ASSERT_EQ(loop.tick(99), status::ok);
  ASSERT_TRUE(shared.contacts.refresh());
  const linear_contact& c = shared.contacts.front();
  EXPECT_NEAR(c.on_probe_w.force.z, 2.0, 1e-12);
  EXPECT_NEAR(c.stiffness(2, 2), -2000.0, 1e-9);
  EXPECT_EQ(c.T_wc.position, T_wc.position);
  EXPECT_EQ(c.time_ns, 42);
  EXPECT_EQ(c.contacts, 3U);
  EXPECT_NEAR(c.max_depth_m, 0.001, 1e-15);
  EXPECT_NEAR(c.direction_ab_w.z, -1.0, 1e-15);
  EXPECT_EQ(c.answer, status::ok);
}

TEST_F(contact_loop_test, keeps_a_result_back_until_it_is_published) {
  contact_loop<analytic_wall> loop({}, {{pose{}}, vec3(0.0)}, shared);
  put({}, 1);
  ASSERT_EQ(loop.compute(1), status::ok);
  EXPECT_FALSE(shared.contacts.refresh());
  loop.publish();
  EXPECT_TRUE(shared.contacts.refresh());
  loop.publish();
  EXPECT_FALSE(shared.contacts.refresh());
}

TEST_F(contact_loop_test, does_not_render_the_same_pose_twice) {
  contact_loop<analytic_wall> loop({}, {{pose{}}, vec3(0.0)}, shared);
  put({}, 1);
  ASSERT_EQ(loop.tick(1), status::ok);
  ASSERT_EQ(loop.tick(2), status::ok);
  EXPECT_EQ(loop.computed(), 1U);
}

TEST_F(contact_loop_test, a_renderer_that_fails_leaves_an_empty_contact_that_says_so) {
  analytic_wall wall;
  wall.answer = status::backend_failed;
  contact_loop<analytic_wall> loop(wall, {{pose{}}, vec3(0.0)}, shared);
  put({quat(1, 0, 0, 0), {0, 0, -0.01}}, 1);
  EXPECT_EQ(loop.tick(1), status::backend_failed);
  ASSERT_TRUE(shared.contacts.refresh());
  EXPECT_EQ(shared.contacts.front().answer, status::backend_failed);
  EXPECT_EQ(shared.contacts.front().on_probe_w.force, vec3(0.0));
}

// Answers whatever it holds.
struct held_answer {
  tick what{};
  std::array<contact, 3> contacts{};
  std::array<penetration, 3> depths{};
  status answer = status::ok;
  status step(const scene_pose&, tick& out) noexcept {
    out = what;
    out.contacts = contacts;
    out.depths = depths;
    return answer;
  }
};

TEST_F(contact_loop_test, weights_the_direction_by_depth) {
  held_answer renderer;
  const vec3 directions[] = {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}};
  const double depths_m[] = {0.003, 0.001, -0.5};  // the last one does not touch
  for (std::size_t i = 0; i < 3; ++i) {
    renderer.contacts[i].window.n_ab_w = directions[i];
    renderer.depths[i].depth_m = depths_m[i];
  }
  contact_loop<held_answer> loop(renderer, {{pose{}}, vec3(0.0)}, shared);
  put({}, 1);
  ASSERT_EQ(loop.tick(1), status::ok);
  ASSERT_TRUE(shared.contacts.refresh());
  EXPECT_LT(glm::length(shared.contacts.front().direction_ab_w - vec3(0.25, 0.0, -0.75)), 1e-15);
  EXPECT_EQ(shared.contacts.front().contacts, 2U);
  EXPECT_EQ(shared.contacts.front().max_depth_m, 0.003);
}

// A renderer that fails may leave anything behind.
TEST_F(contact_loop_test, hands_over_no_force_of_a_renderer_that_failed) {
  for (const status s : {status::ok, status::capacity_reached, status::invalid_pose, status::not_finite,
                         status::stale_input, status::not_ready, status::backend_failed}) {
    held_answer renderer;
    renderer.what.force.on_probe_w.force = {1, 2, 3};
    renderer.what.force.stiffness(0, 0) = -5.0;
    renderer.answer = s;
    exchange own;
    contact_loop<held_answer> loop(renderer, {{pose{}}, vec3(0.0)}, own);
    own.poses.publish();
    EXPECT_EQ(loop.tick(1), s);
    ASSERT_TRUE(own.contacts.refresh());
    const linear_contact& c = own.contacts.front();
    const bool usable = s == status::ok || s == status::capacity_reached;
    EXPECT_EQ(c.answer, s);
    EXPECT_EQ(c.on_probe_w.force, usable ? vec3(1, 2, 3) : vec3(0.0)) << to_string(s);
    EXPECT_EQ(c.stiffness(0, 0), usable ? -5.0 : 0.0) << to_string(s);
  }
}

// What is not finite is told and goes no further, wherever it stands.
TEST_F(contact_loop_test, hands_over_nothing_that_is_not_finite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (std::size_t where = 0; where < 12; ++where) {
      held_answer renderer;
      renderer.what.force.on_probe_w.force = {1, 2, 3};
      if (where < 3) renderer.what.force.on_probe_w.force[static_cast<int>(where)] = bad;
      if (where >= 3 && where < 6) renderer.what.force.on_probe_w.torque[static_cast<int>(where) - 3] = bad;
      if (where >= 6) renderer.what.force.stiffness(where - 6, 11 - where) = bad;
      exchange own;
      contact_loop<held_answer> loop(renderer, {{pose{}}, vec3(0.0)}, own);
      own.poses.back() = {{}, 7};
      own.poses.publish();
      static_cast<void>(loop.tick(7));
      ASSERT_TRUE(own.contacts.refresh());
      const linear_contact& c = own.contacts.front();
      EXPECT_EQ(c.answer, status::not_finite) << where;
      EXPECT_TRUE(is_zero(c.on_probe_w)) << where;
      EXPECT_TRUE(is_finite(c.stiffness)) << where;
      EXPECT_EQ(c.time_ns, 7);
    }
  }
}

}  // namespace
