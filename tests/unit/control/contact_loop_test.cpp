#include <gtest/gtest.h>

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

}  // namespace
