#include "asperity/core/math.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

namespace {

using namespace asperity;

vec3 random_vector(std::mt19937_64& rng, double size) {
  std::uniform_real_distribution<double> u(-size, size);
  return {u(rng), u(rng), u(rng)};
}

TEST(math, skew_is_the_cross_product) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 100; ++i) {
    const vec3 a = random_vector(rng, 3.0);
    const vec3 b = random_vector(rng, 3.0);
    EXPECT_EQ(skew(a) * b, glm::cross(a, b));
  }
}

TEST(math, exp_of_a_quarter_turn_about_z_takes_x_to_y) {
  const quat q = exp_rotation({0, 0, std::numbers::pi / 2});
  const vec3 y = q * vec3(1, 0, 0);
  EXPECT_NEAR(y.x, 0.0, 1e-15);
  EXPECT_NEAR(y.y, 1.0, 1e-15);
}

TEST(math, log_inverts_exp_from_tiny_to_almost_half_a_turn) {
  std::mt19937_64 rng(2);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 2.0, 3.1, 3.14159}) {
    const vec3 phi = angle * glm::normalize(random_vector(rng, 1.0));
    const vec3 back = log_rotation(exp_rotation(phi));
    EXPECT_LE(glm::length(back - phi), 1e-12 * (1.0 + angle)) << angle;
  }
}

TEST(math, log_takes_the_short_way_for_either_sign_of_the_quaternion) {
  const quat q = exp_rotation({0.3, -0.2, 0.1});
  const vec3 a = log_rotation(q);
  const vec3 b = log_rotation(-q);
  EXPECT_LE(glm::length(a - b), 1e-15);
}

TEST(math, exp_of_a_small_vector_has_unit_length) {
  for (const double angle : {1e-8, 0.9e-6, 1.1e-6, 1e-4}) {
    EXPECT_NEAR(glm::length(exp_rotation({angle, 0, 0})), 1.0, 1e-15);
  }
}

TEST(math, smoothstep_has_the_slope_it_says) {
  for (const double x : {-0.5, 0.01, 0.3, 0.5, 0.99, 1.5}) {
    const double h = 1e-6;
    EXPECT_NEAR(smoothstep_slope(x), (smoothstep(x + h) - smoothstep(x - h)) / (2 * h), 1e-6);
  }
  EXPECT_EQ(smoothstep(-1.0), 0.0);
  EXPECT_EQ(smoothstep(2.0), 1.0);
}

TEST(math, any_orthogonal_is_unit_and_orthogonal) {
  std::mt19937_64 rng(3);
  for (int i = 0; i < 200; ++i) {
    const vec3 n = glm::normalize(random_vector(rng, 1.0));
    const vec3 u = any_orthogonal(n);
    EXPECT_NEAR(glm::dot(u, n), 0.0, 1e-15);
    EXPECT_NEAR(glm::length(u), 1.0, 1e-15);
  }
}

TEST(math, is_finite_rejects_nan_and_infinity_on_each_axis) {
  for (int k = 0; k < 3; ++k) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
      vec3 v(1.0);
      v[k] = bad;
      EXPECT_FALSE(is_finite(v));
    }
  }
  EXPECT_TRUE(is_finite(vec3(1e308, -1e308, 0.0)));
}

}  // namespace
