#include <cmath>
#include <gtest/gtest.h>

#include <asperity/control/workspace_map.hpp>

namespace {

using namespace asperity;

TEST(workspace_map, is_the_identity_by_default) {
  const workspace_map map;
  const pose T{exp_rotation({0.1, 0.2, 0.3}), {1, 2, 3}};
  EXPECT_EQ(map.to_world(T).position, T.position);
  const wrench w{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(map.to_device(w, {1, 2, 3}, {1, 2, 3}).torque, w.torque);
}

// p_w = T_wd (scale p_d): the scale is about the device's origin, which stays where T_wd puts it.
TEST(workspace_map, scales_about_the_devices_origin) {
  const workspace_map map{{exp_rotation({0, 0, 0.5 * 3.141592653589793}), {1, 2, 3}}, 2.0, {}};
  EXPECT_EQ(map.to_world(pose{}).position, vec3(1, 2, 3));
  const pose T = map.to_world(pose{exp_rotation({0.1, 0, 0}), {0.25, 0, 0.5}});
  EXPECT_LT(glm::length(T.position - vec3(1, 2.5, 4)), 1e-15);
  EXPECT_LT(glm::length(T.rotation * vec3(0, 1, 0) - vec3(-std::cos(0.1), 0, std::sin(0.1))), 1e-15);
}

// Power at the handle equals power at the probe's point, for any map and lever: the map itself makes no energy.
TEST(workspace_map, neither_makes_nor_takes_energy) {
  const workspace_map map{{exp_rotation({0.4, -1.0, 0.3}), {0.1, 0.2, -0.3}}, 2.5, {}};
  const pose T_dh{exp_rotation({-0.2, 0.5, 0.9}), {0.03, -0.02, 0.05}};
  const twist velocity_d{{0.1, -0.2, 0.05}, {1.0, 2.0, -0.5}};
  const wrench on_hand_w{{1.0, -2.0, 3.0}, {0.1, 0.2, -0.1}};

  const pose T_wh = map.to_world(T_dh);
  const twist handle_w = map.to_world(velocity_d);
  const vec3 point_w = T_wh.position + vec3(0.04, -0.01, 0.07);
  const vec3 point_velocity_w = handle_w.linear + glm::cross(handle_w.angular, point_w - T_wh.position);
  const double in_world = glm::dot(on_hand_w.force, point_velocity_w) + glm::dot(on_hand_w.torque, handle_w.angular);

  const wrench w_d = map.to_device(on_hand_w, point_w, T_wh.position);
  const double at_device = glm::dot(w_d.force, velocity_d.linear) + glm::dot(w_d.torque, velocity_d.angular);
  EXPECT_NEAR(at_device, in_world, 1e-12);
}

TEST(workspace_map, velocity_is_the_derivative_of_the_pose) {
  const workspace_map map{{exp_rotation({0.4, -1.0, 0.3}), {0.1, 0.2, -0.3}}, 2.5, {}};
  const twist v{{0.1, -0.2, 0.05}, {1.0, 2.0, -0.5}};
  const double h = 1e-6;
  const pose before = map.to_world(pose{quat(1, 0, 0, 0), {0.01, 0.02, 0.03}});
  const pose after = map.to_world(pose{exp_rotation(h * v.angular), vec3(0.01, 0.02, 0.03) + h * v.linear});
  const vec3 dx = (after.position - before.position) / h;
  const vec3 dphi = log_rotation(after.rotation * glm::conjugate(before.rotation)) / h;
  EXPECT_LT(glm::length(dx - map.to_world(v).linear), 1e-8);
  EXPECT_LT(glm::length(dphi - map.to_world(v).angular), 1e-8);
}

}  // namespace
