// What free bodies do that can be said without a computer: rest, be pushed, stand on each other, fall.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "session/rt/tick_trap.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/bodies/block_scene.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

// Dropped on the table, light and heavy, a block comes to rest where the table holds its weight; where it may, it sleeps.
TEST(free_bodies, come_to_rest) {
  drawn d(seed_of(fresh_seed("free_bodies", "3 blocks dropped, 40 at length"), "rest"));
  const model_ptr table = box_with(table_of_blocks_half_m, 1.0), block = box_with(block_half_m, 0.5);
  for (int i = 0; i < extent(3, 40); ++i) {
    const bool may_sleep = i % 2 == 0;
    const double mass_kg = d.log_between(0.01, 10.0), height_m = d.between(0.0, 0.004);
    const pose at{exp_rotation({d.between(-0.1, 0.1), d.between(-0.1, 0.1), d.between(-3.0, 3.0)}),
                  {d.between(-0.02, 0.02), d.between(-0.01, 0.01), block_at_rest_m + 0.002 + height_m}};
    free_bodies_settings s = quick_settings();
    if (!may_sleep) s.sleep_after_s = 0.0;
    free_bodies bodies = made({.standing = {{table}}, .free = {{.model = block, .T_wb = at, .mass_kg = mass_kg}}}, s);
    const double weight_n = mass_kg * gravity_m_per_s2;
    double lowest_m = 1.0;
    for (int n = 0; n < 1200; ++n) {
      bodies.advance(1e-3);
      ASSERT_EQ(bodies.last(), status::ok);
      lowest_m = std::min(lowest_m, bodies.T_wb(0).position.z);
    }
    EXPECT_EQ(bodies.sleeps(0), may_sleep) << mass_kg << " kg";
    // It may fall asleep while it still trembles a little.
    EXPECT_NEAR(bodies.on_standing(0).force.z, -weight_n, (may_sleep ? 0.1 : 2e-3) * weight_n) << mass_kg << " kg";
    EXPECT_NEAR(bodies.on_free(0).force.z, -bodies.on_standing(0).force.z, 1e-9);
    EXPECT_LT(glm::length(bodies.velocity_w(0).linear), 1e-3);
    // On one point of 200 N/mm 10 kg lie 0.5 mm deep, and come three times as deep when they fall.
    EXPECT_NEAR(bodies.T_wb(0).position.z, block_at_rest_m, 2e-5 + weight_n / 2e5);
    EXPECT_GT(lowest_m, block_at_rest_m - 3e-4 - 3.0 * weight_n / 2e5) << mass_kg << " kg from " << height_m;
  }
}

struct pushed {
  double hand_n = 0.0, table_n = 0.0, normal_n = 0.0;  // means over a second
  double gained_n = 0.0;                               // momentum that the block gained in it, per second
  double weight_n = 0.0;
};

// The probe comes at 10 mm/s to a block and pushes it over the table; its own friction is none.
pushed push_over_table(double mass_kg, double friction, double angle_rad, double coupling_n_per_m) {
  free_bodies_settings s = quick_settings();
  s.coupling.stiffness_n_per_m = coupling_n_per_m;
  free_bodies bodies = made({.probe = box_with(finger_half_m, 0.0),
                             .standing = {{box_with(table_of_blocks_half_m, 1.0)}},
                             .free = {{.model = box_with(block_half_m, friction),
                                       .T_wb = {exp_rotation({0.0, 0.0, angle_rad}), {-0.02, 0.0, block_at_rest_m}},
                                       .mass_kg = mass_kg}}},
                            s);
  // Where the hand begins, a stretched coupling that pushes with the block's friction is 2 mm from it.
  const vec3 way = exp_rotation({0.0, 0.0, angle_rad}) * vec3(1.0, 0.0, 0.0);
  const double touches_m = block_half_m.x + finger_half_m.x;
  const double stretch_m = friction * mass_kg * gravity_m_per_s2 / coupling_n_per_m;
  pose T_wh{exp_rotation({0.0, 0.0, angle_rad}), vec3(-0.02, 0.0, block_at_rest_m - 0.004) - (touches_m + 0.001) * way};
  bodies.place(T_wh);
  const double speed = 0.01, until_slips_s = (0.001 + stretch_m) / speed;
  pushed out{.weight_n = mass_kg * gravity_m_per_s2};
  const int begins = static_cast<int>(1000.0 * until_slips_s) + 500, steps = begins + 1000;
  for (int i = 0; i < steps; ++i) {
    T_wh.position += speed * 1e-3 * way;
    const wrench felt = bodies.follow(T_wh, 1e-3);
    EXPECT_EQ(bodies.last(), status::ok);
    const vec3 on_table_n = bodies.on_standing(0).force;
    const double momentum = mass_kg * glm::dot(bodies.velocity_w(0).linear, way);
    if (i == begins - 1) out.gained_n -= momentum;
    if (i == steps - 1) out.gained_n += momentum;
    if (i < begins) continue;
    out.normal_n -= on_table_n.z / (steps - begins);
    out.hand_n -= glm::dot(felt.force, way) / (steps - begins);
    out.table_n += glm::dot(on_table_n, way) / (steps - begins);
  }
  EXPECT_LT(bodies.energy().most_made_j, 1e-15);
  return out;
}

TEST(free_bodies, are_pushed_with_their_friction) {
  drawn d(seed_of(fresh_seed("free_bodies", "3 pushes from 10 g to 10 kg, 25 at length"), "push"));
  const int n = extent(3, 25);
  for (int i = 0; i < n; ++i) {
    const double mass_kg = 0.01 * std::pow(1000.0, static_cast<double>(i) / (n - 1));
    // At most the 20 N of a device. From 0.8 on a block of this height stands on its front edge, and chatters.
    const double friction = d.between(0.1, std::min(0.7, 20.0 / (mass_kg * gravity_m_per_s2)));
    const double stiffness = d.log_between(1000.0, 5000.0), angle_rad = d.between(-3.0, 3.0);
    const pushed of = push_over_table(mass_kg, friction, angle_rad, stiffness);
    const double closed_n = friction * of.weight_n;
    std::printf("  %.3f kg, friction %.2f, turned %.2f, coupling %.0f N/m: hand %.4f, table %.4f of %.4f N\n", mass_kg,
                friction, angle_rad, stiffness, of.hand_n, of.table_n, closed_n);
    EXPECT_NEAR(of.normal_n, of.weight_n, 2e-3 * of.weight_n);
    EXPECT_NEAR(of.table_n, closed_n, 5e-3 * closed_n);
    EXPECT_NEAR(of.hand_n, of.table_n + of.gained_n, 2e-3 * closed_n);
  }
  EXPECT_LT(std::fabs(push_over_table(0.1, 0.0, 0.4, 2000.0).hand_n), 0.02) << "without friction it is no push";
}

// Five blocks on each other, each turned against the one below, stay where they are.
TEST(free_bodies, stand_on_each_other) {
  drawn d(seed_of(fresh_seed("free_bodies", "a stack of 5 for 1.6 s, 60 s at length"), "stack"));
  for (const bool may_sleep : {false, true}) {
    const model_ptr block = box_with(block_half_m, 0.5);
    free_scene scene{.standing = {{box_with(table_of_blocks_half_m, 1.0)}}};
    for (int i = 0; i < 5; ++i) {
      scene.free.push_back({.model = block,
                            .T_wb = {exp_rotation({0.0, 0.0, d.between(-3.0, 3.0)}),
                                     {d.between(-0.002, 0.002), d.between(-0.002, 0.002),
                                      block_at_rest_m + 0.0003 + i * (2.0 * block_half_m.z + 0.0003)}}});
    }
    free_bodies_settings s = quick_settings();
    s.render_every = 4;
    if (!may_sleep) s.sleep_after_s = 0.0;
    free_bodies bodies = made(scene, s);
    let_be(bodies, 0.8);
    std::vector<pose> stood;
    for (std::size_t i = 0; i < bodies.size(); ++i) stood.push_back(bodies.T_wb(i));
    let_be(bodies, extent(0.8, 59.0));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_LT(glm::distance(bodies.T_wb(i).position, stood[i].position), 2e-5) << i;
      EXPECT_LT(glm::length(log_rotation(bodies.T_wb(i).rotation * glm::conjugate(stood[i].rotation))), 1e-3) << i;
      EXPECT_GT(bodies.T_wb(i).position.z, block_at_rest_m + static_cast<double>(i) * 2.0 * block_half_m.z - 2e-4);
      EXPECT_EQ(bodies.sleeps(i), may_sleep) << i;
    }
    EXPECT_EQ(bodies.last(), status::ok);
    EXPECT_LT(bodies.energy().most_made_j, 1e-15);
  }
}

// A block that sleeps on another falls when that is taken away, and one that is touched wakes.
TEST(free_bodies, wake_with_what_they_touch) {
  const model_ptr block = box_with(block_half_m, 0.5);
  free_bodies bodies = made({.probe = box_with(finger_half_m, 0.5),
                             .standing = {{box_with(table_of_blocks_half_m, 1.0)}},
                             .free = {{.model = block, .T_wb = {quat(1, 0, 0, 0), {0, 0, block_at_rest_m}}},
                                      {.model = block, .T_wb = {quat(1, 0, 0, 0), {0, 0, block_at_rest_m + 0.02401}}},
                                      {.model = block, .T_wb = {quat(1, 0, 0, 0), {0.045, 0, block_at_rest_m}}}}},
                            quick_settings());
  const pose away{quat(1, 0, 0, 0), {0.0, 0.0, 0.1}};
  bodies.place(away);
  for (int i = 0; i < 1500; ++i) static_cast<void>(bodies.follow(away, 1e-3));
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(bodies.sleeps(i)) << i;

  // From above, slowly, on the upper one: both wake, the third does not.
  pose T_wh{quat(1, 0, 0, 0), {0.0, 0.0, block_at_rest_m + 0.024 + 0.012 + 0.004 + 0.001}};
  bodies.place(T_wh);
  for (int i = 0; i < 400; ++i) {
    T_wh.position.z -= 1e-5;
    static_cast<void>(bodies.follow(T_wh, 1e-3));
  }
  EXPECT_FALSE(bodies.sleeps(0));
  EXPECT_FALSE(bodies.sleeps(1));
  EXPECT_TRUE(bodies.sleeps(2));
  EXPECT_NEAR(bodies.on_standing(0).force.z, -3.0 * bodies.mass_kg(0) * gravity_m_per_s2 - 0.5 * 3.0, 0.05)
      << "three weights and 3 mm of 500 N/m";

  bodies.place(away);
  for (int i = 0; i < 1500; ++i) static_cast<void>(bodies.follow(away, 1e-3));
  ASSERT_TRUE(bodies.sleeps(1));
  ASSERT_TRUE(bodies.put(0, {quat(1, 0, 0, 0), {-0.04, 0, block_at_rest_m}}));
  for (int i = 0; i < 1500; ++i) static_cast<void>(bodies.follow(away, 1e-3));
  EXPECT_NEAR(bodies.T_wb(1).position.z, block_at_rest_m, 1e-4);
  EXPECT_TRUE(bodies.sleeps(1));

  ASSERT_TRUE(bodies.push(2, {{0.0, 0.0, 0.5}, vec3(0.0)}));
  EXPECT_FALSE(bodies.sleeps(2));
}

// What follow() and advance() must not do: bodies at rest, pushed, falling, with textures.
TEST(free_bodies, stay_inside_the_trap) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  const model_ptr block = box_with(block_half_m, 0.5), rough = box_with(block_half_m, 0.5, ridges(5e-5, 0.003));
  free_bodies bodies =
      made({.probe = box_with(finger_half_m, 0.5),
            .standing = {{box_with(table_of_blocks_half_m, 1.0, ridges(5e-5, 0.004))}},
            .free = {{.model = block, .T_wb = {quat(1, 0, 0, 0), {0, 0, block_at_rest_m + 1e-3}}},
                     {.model = rough, .T_wb = {quat(1, 0, 0, 0), {0.003, 0, block_at_rest_m + 0.028}}},
                     {.model = rough, .T_wb = {exp_rotation({0.5, 0.3, 0.2}), {0.045, 0, block_at_rest_m + 0.02}}}}},
           quick_settings());
  pose T_wh{quat(1, 0, 0, 0), {-0.03, 0.0, block_at_rest_m}};
  bodies.place(T_wh);
  tick_trap trap;
  bool all_ok = true;
  for (int i = 0; i < 1500; ++i) {
    T_wh.position.x += i < 900 ? 2e-5 : -2e-5;
    trap([&] { static_cast<void>(bodies.follow(T_wh, 1e-3)); });
    all_ok = all_ok && bodies.last() == status::ok;
  }
  EXPECT_TRUE(all_ok);
  EXPECT_EQ(trap.ticks(), 1500U);
  EXPECT_GT(bodies.T_wb(0).position.x, 2e-4) << "it was pushed";
}

TEST(free_bodies, say_what_is_wrong_with_a_scene) {
  const model_ptr block = box_with(block_half_m, 0.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto told = [](const free_scene& scene, const free_bodies_settings& s = {}) {
    const result<free_bodies> out = free_bodies::make(scene, s);
    return out ? std::string() : out.error().message;
  };
  EXPECT_NE(told({.probe = block}).find("no free body"), std::string::npos);
  EXPECT_NE(told({.free = {{}}}).find("free body 0 has no model"), std::string::npos);
  EXPECT_NE(told({.free = {{.model = block, .T_wb = {quat(2, 0, 0, 0), {}}}}}).find("pose of free body 0"),
            std::string::npos);
  EXPECT_NE(told({.free = {{.model = block, .mass_kg = nan}}}).find("mass of free body 0"), std::string::npos);
  EXPECT_NE(told({.free = {{.model = block, .density_kg_per_m3 = 1e12}}}).find("1e-6 to 1e4"), std::string::npos);
  EXPECT_NE(told({.standing = {{}}, .free = {{.model = block}}}).find("standing body 0"), std::string::npos);
  EXPECT_NE(told({.free = std::vector<free_body>(33, {.model = block})}).find("room for 32"), std::string::npos);
  free_bodies_settings s;
  s.substeps = 0;
  EXPECT_NE(told({.free = {{.model = block}}}, s).find("substeps"), std::string::npos);
  s = {};
  s.gravity_m_per_s2.x = nan;
  EXPECT_NE(told({.free = {{.model = block}}}, s).find("gravity"), std::string::npos);

  free_bodies bodies = made({.free = {{.model = block}}}, quick_settings());
  EXPECT_FALSE(bodies.put(1, {}));
  EXPECT_FALSE(bodies.put(0, {quat(0, 0, 0, 0), {}}));
  EXPECT_FALSE(bodies.push(0, {vec3(nan), vec3(0.0)}));
  EXPECT_TRUE(is_zero(bodies.follow({}, 1e-3))) << "nobody holds a probe";
  EXPECT_EQ(bodies.last(), status::invalid_pose);
  bodies.advance(nan);
  EXPECT_EQ(bodies.last(), status::invalid_pose);
}

}  // namespace
