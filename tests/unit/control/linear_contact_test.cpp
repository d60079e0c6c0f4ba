#include <gtest/gtest.h>

#include <asperity/control/linear_contact.hpp>

namespace {

using namespace asperity;

linear_contact spring_below(double depth_m) {
  linear_contact c;
  const vec6 g{vec3(0, 0, -1), vec3(0.01, 0.0, 0.0)};
  c.on_probe_w = to_wrench(-2000.0 * depth_m * g);
  add_outer(c.stiffness, -2000.0, g);
  c.direction_ab_w = {0, 0, -1};
  c.answer = status::ok;
  return c;
}

TEST(linear_contact, is_exact_for_a_linear_contact) {
  const linear_contact c = spring_below(0.001);
  const double angle = 0.02;
  const contact_evaluation e = evaluate(c, {exp_rotation({angle, 0, 0}), {0.5, -0.5, -0.0005}});
  // depth grows by the translation along n and by the rotation's gradient
  const double depth = 0.001 + 0.0005 + 0.01 * angle;
  EXPECT_NEAR(e.on_probe_w.force.z, 2000.0 * depth, 1e-9);
  EXPECT_NEAR(e.on_probe_w.torque.x, -2000.0 * depth * 0.01, 1e-11);
  EXPECT_EQ(e.stiffness.m, c.stiffness.m);
}

TEST(linear_contact, measures_rotation_in_world_axes_from_the_pose_it_was_made_at) {
  linear_contact c = spring_below(0.001);
  c.T_wc.rotation = exp_rotation({0.3, -0.7, 1.1});
  const pose turned{exp_rotation({0.02, 0, 0}) * c.T_wc.rotation, vec3(0.0)};
  EXPECT_NEAR(evaluate(c, turned).on_probe_w.force.z, 2000.0 * (0.001 + 0.01 * 0.02), 1e-9);
}

TEST(linear_contact, never_pulls) {
  const linear_contact c = spring_below(0.001);
  EXPECT_FALSE(evaluate(c, {quat(1, 0, 0, 0), {0, 0, 0.0009}}).pulling);
  const contact_evaluation away = evaluate(c, {quat(1, 0, 0, 0), {0, 0, 0.0011}});
  EXPECT_TRUE(away.pulling);
  EXPECT_EQ(away.on_probe_w.force, vec3(0.0));
  EXPECT_EQ(away.stiffness.m, mat6{}.m);
}

TEST(linear_contact, keeps_both_signs_in_a_slot) {
  linear_contact slot = spring_below(0.0);
  slot.direction_ab_w = {0, 0, -0.1};  // two faces, one slightly deeper
  const contact_evaluation e = evaluate(slot, {quat(1, 0, 0, 0), {0, 0, 0.0005}});
  EXPECT_FALSE(e.pulling);
  EXPECT_LT(e.on_probe_w.force.z, 0.0);
}

TEST(linear_contact, fades_after_fifty_milliseconds_over_fifty_more) {
  const contact_ageing ageing;
  EXPECT_EQ(strength_at(0, ageing), 1.0);
  EXPECT_EQ(strength_at(50'000'000, ageing), 1.0);
  EXPECT_DOUBLE_EQ(strength_at(75'000'000, ageing), 0.5);
  EXPECT_EQ(strength_at(100'000'000, ageing), 0.0);
  EXPECT_EQ(strength_at(std::int64_t{1} << 62, ageing), 0.0);
}

}  // namespace
