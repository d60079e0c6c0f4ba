#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include <asperity/device/simulated/motion_script.hpp>

namespace {

using namespace asperity;

constexpr motion_kind kinds[] = {motion_kind::press, motion_kind::scrub, motion_kind::twist, motion_kind::tap,
                                 motion_kind::free};

motion_settings tilted(motion_kind kind) {
  return {.kind = kind,
          .T_dh = {exp_rotation({0.4, -0.2, 0.9}), {0.1, 0.2, 0.3}},
          .direction_d = {0.0, 0.6, -0.8},
          .sideways_d = {1.0, 0.0, 0.0},
          .amplitude_rad = 0.9};
}

TEST(motion_script, begins_at_rest_at_its_first_pose) {
  for (const motion_kind kind : kinds) {
    const hand_target t = motion_script(tilted(kind), 3).at(0.0);
    EXPECT_EQ(t.T_dh.position, vec3(0.1, 0.2, 0.3));
    EXPECT_EQ(t.velocity_d.linear, vec3(0.0));
    EXPECT_EQ(t.velocity_d.angular, vec3(0.0));
  }
}

TEST(motion_script, velocity_is_the_derivative_of_the_pose) {
  const double h = 1e-6;
  for (const motion_kind kind : kinds) {
    const motion_script script(tilted(kind), 3);
    for (double t = 0.0; t < 3.0; t += 0.0137) {
      const hand_target a = script.at(t - h);
      const hand_target b = script.at(t + h);
      const hand_target m = script.at(t);
      EXPECT_LT(glm::length((b.T_dh.position - a.T_dh.position) / (2 * h) - m.velocity_d.linear), 1e-5);
      const vec3 turn = log_rotation(b.T_dh.rotation * glm::conjugate(a.T_dh.rotation)) / (2 * h);
      EXPECT_LT(glm::length(turn - m.velocity_d.angular), 1e-4);
      EXPECT_TRUE(is_valid(m.T_dh));
    }
  }
}

TEST(motion_script, approaches_and_then_moves_as_told) {
  const motion_settings c = tilted(motion_kind::scrub);
  const motion_script press(tilted(motion_kind::press));
  EXPECT_LT(glm::length(press.at(5.0).T_dh.position - (c.T_dh.position + c.depth_m * c.direction_d)), 1e-15);
  const motion_script scrub(c);
  const vec3 off = scrub.at(c.approach_s + 1.25).T_dh.position - press.at(5.0).T_dh.position;
  EXPECT_NEAR(off.x, c.amplitude_m, 1e-9);  // a quarter of the second wave
  EXPECT_NEAR(off.y, 0.0, 1e-15);
  const motion_script twist(tilted(motion_kind::twist));
  const vec3 turned = log_rotation(twist.at(c.approach_s + 1.25).T_dh.rotation * glm::conjugate(c.T_dh.rotation));
  EXPECT_LT(glm::length(turned - 0.9 * c.direction_d), 1e-9);
}

TEST(motion_script, taps_in_an_uneven_rhythm_between_the_pressed_pose_and_the_lift) {
  motion_settings c = tilted(motion_kind::tap);
  c.frequency_hz = 4.0;
  const vec3 pressed = c.T_dh.position + c.depth_m * c.direction_d;
  std::vector<double> blows_s;
  double low = 1.0;
  double high = 0.0;
  const auto lift_at = [&](std::uint64_t seed, double t) {
    const vec3 off = motion_script(c, seed).at(t).T_dh.position - pressed;
    EXPECT_LT(glm::length(off - glm::dot(off, c.direction_d) * c.direction_d), 1e-15);
    return -glm::dot(off, c.direction_d);
  };
  for (double t = c.approach_s + 0.3; t < 10.0; t += 0.001) {
    const double lift = lift_at(1, t);
    low = std::min(low, lift);
    high = std::max(high, lift);
    if (lift < lift_at(1, t - 0.001) && lift < lift_at(1, t + 0.001)) blows_s.push_back(t);
  }
  EXPECT_GE(low, -1e-15);
  EXPECT_LT(low, 1e-5);
  EXPECT_LE(high, c.amplitude_m);
  EXPECT_GT(high, 0.999 * c.amplitude_m);
  ASSERT_GE(blows_s.size(), 30U);  // four per second
  ASSERT_LE(blows_s.size(), 45U);
  double shortest_s = 1.0;
  double longest_s = 0.0;
  for (std::size_t i = 1; i < blows_s.size(); ++i) {
    shortest_s = std::min(shortest_s, blows_s[i] - blows_s[i - 1]);
    longest_s = std::max(longest_s, blows_s[i] - blows_s[i - 1]);
  }
  EXPECT_GT(longest_s, 1.05 * shortest_s);
  EXPECT_NE(lift_at(1, 3.3), lift_at(2, 3.3));
}

TEST(motion_script, wanders_by_seed_inside_its_box) {
  const motion_settings c = tilted(motion_kind::free);
  const motion_script one(c, 1);
  const motion_script again(c, 1);
  const motion_script two(c, 2);
  bool differs = false;
  for (double t = 0.0; t < 10.0; t += 0.01) {
    const vec3 p = one.at(t).T_dh.position;
    EXPECT_EQ(p, again.at(t).T_dh.position);
    differs = differs || p != two.at(t).T_dh.position;
    const vec3 off = glm::abs(p - c.T_dh.position);
    EXPECT_LE(std::max({off.x, off.y, off.z}), c.amplitude_m * (1 + 1e-12));
  }
  EXPECT_TRUE(differs);
}

}  // namespace
