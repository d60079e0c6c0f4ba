#include "asperity/core/spatial.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace {

using namespace asperity;

TEST(spatial, transport_keeps_the_power_of_any_rigid_motion) {
  const wrench w{{1, -2, 3}, {0.1, 0.2, -0.4}};
  const vec3 from{0.3, 0.1, -0.2};
  const vec3 to{-0.5, 0.4, 0.9};
  const twist at_from{{0.7, -0.1, 0.2}, {0.3, 0.5, -0.6}};
  const twist at_to{at_from.linear + glm::cross(at_from.angular, to - from), at_from.angular};
  EXPECT_NEAR(dot(to_vec6(w), to_vec6(at_from)), dot(to_vec6(transport(w, from, to)), to_vec6(at_to)), 1e-15);
}

TEST(spatial, solve_inverts_well_conditioned_systems) {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int trial = 0; trial < 100; ++trial) {
    mat6 a;
    vec6 x;
    for (double& e : a.m) e = u(rng);
    for (std::size_t i = 0; i < 6; ++i) {
      a(i, i) += 4.0;
      x[i] = u(rng);
    }
    vec6 found;
    ASSERT_TRUE(solve(a, a * x, found));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], x[i], 1e-12);
  }
}

TEST(spatial, solve_needs_pivoting_here) {
  mat6 a;  // a permutation: every diagonal entry is zero
  for (std::size_t i = 0; i < 6; ++i) a(i, (i + 1) % 6) = 1.0;
  vec6 x;
  vec6 b;
  for (std::size_t i = 0; i < 6; ++i) b[i] = static_cast<double>(i);
  ASSERT_TRUE(solve(a, b, x));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(x[(i + 1) % 6], b[i]);
}

TEST(spatial, solve_refuses_singular_and_nan_systems_and_leaves_the_answer_alone) {
  vec6 x{{1, 2, 3}, {4, 5, 6}};
  EXPECT_FALSE(solve(mat6{}, vec6{}, x));
  mat6 a;
  for (std::size_t i = 0; i < 6; ++i) a(i, i) = 1.0;
  a(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve(a, vec6{}, x));
  // Regular, with an answer that is none: a load that is not finite, and one over all numbers.
  a(2, 2) = 1e-200;
  for (const double load : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 1e200}) {
    EXPECT_FALSE(solve(a, {{0, 0, load}, vec3(0.0)}, x)) << load;
  }
  EXPECT_EQ(x.linear, vec3(1, 2, 3));
  EXPECT_EQ(x.angular, vec3(4, 5, 6));
}

TEST(spatial, outer_product_and_blocks_land_where_they_should) {
  const vec6 g{{1, 2, 3}, {4, 5, 6}};
  mat6 m;
  add_outer(m, 2.0, g);
  EXPECT_EQ(m(0, 5), 12.0);
  EXPECT_EQ(m(5, 0), 12.0);
  add_outer(m, -0.5, {{4, 0, 0}, {0, 0, 1}});  // added to what is there
  EXPECT_EQ(m(0, 5), 10.0);
  EXPECT_EQ(m(0, 0), -6.0);
  EXPECT_EQ(m(1, 2), 12.0);
  set_block(m, 3, 0, skew({1, 2, 3}));
  EXPECT_EQ(m(3, 1), -3.0);  // first row of skew is (0, -z, y)
  EXPECT_EQ(m(3, 2), 2.0);
  EXPECT_EQ(m(0, 3), 8.0);  // the other blocks are untouched
}

}  // namespace
