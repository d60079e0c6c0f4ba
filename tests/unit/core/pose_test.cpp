#include "asperity/core/pose.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace asperity;

const pose T_ab{exp_rotation({0.4, -0.3, 1.2}), {0.1, 0.2, -0.3}};
const pose T_bc{exp_rotation({-1.0, 0.2, 0.5}), {1.0, -2.0, 0.5}};
const vec3 p_c{0.3, 0.7, -0.2};

TEST(pose, composition_applies_the_right_one_first) {
  EXPECT_LE(glm::length((T_ab * T_bc) * p_c - T_ab * (T_bc * p_c)), 1e-15);
}

TEST(pose, inverse_undoes) { EXPECT_LE(glm::length(inverse(T_ab) * (T_ab * p_c) - p_c), 1e-15); }

TEST(pose, quaternion_orders_are_named_conversions) {
  const quat q = quat_from_xyzw({0.1, 0.2, 0.3, 0.4});
  EXPECT_EQ(q.x, 0.1);
  EXPECT_EQ(q.w, 0.4);
  EXPECT_EQ(quat_from_wxyz({0.4, 0.1, 0.2, 0.3}), q);
  EXPECT_EQ(to_xyzw(q), (std::array<double, 4>{0.1, 0.2, 0.3, 0.4}));
}

TEST(pose, validity_needs_finite_numbers_and_a_unit_quaternion) {
  EXPECT_TRUE(is_valid(T_ab));
  pose T = T_ab;
  T.position.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(T));
  T = T_ab;
  T.position.x = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_valid(T));
  T = T_ab;
  T.rotation.w = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(T));
  T = T_ab;
  T.rotation = T.rotation * 1.001;
  EXPECT_FALSE(is_valid(T));
  T.rotation = quat(0, 0, 0, 0);
  EXPECT_FALSE(is_valid(T));
  T = T_ab;
  T.rotation = T.rotation * (1.0 + 1e-9);  // what rounding to nine digits leaves
  EXPECT_TRUE(is_valid(T));
}

}  // namespace
