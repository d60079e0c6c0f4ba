// The oracle of presses itself: touches, thicknesses and true depths of bodies that have closed forms.
#include "law/presses/true_exit.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "law/presses/press_pairs.hpp"
#include "law/presses/press_touch.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/press_bodies.hpp"

namespace asperity::presses {
namespace {

using test_support::extent;
using test_support::fineness;
using test_support::fresh_seed;
using test_support::make_press_solid;
using test_support::seed_of;

constexpr double mm = 1e-3;

triangle_mesh solid(const char* name) { return make_press_solid(name, fineness::fine).value(); }

class numbers {
 public:
  explicit numbers(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11U) * 0x1p-53; }
  quat turn() {
    vec3 phi;
    do phi = {between(-3.2, 3.2), between(-3.2, 3.2), between(-3.2, 3.2)};
    while (glm::length(phi) > 3.14159);
    return exp_rotation(phi);
  }

 private:
  std::mt19937_64 bits_;
};

/// Of the ball's mesh below its sphere.
constexpr double facets = 2e-3;

TEST(true_exit, of_a_ball_in_a_slab_is_the_way_to_the_nearest_face) {
  const triangle_mesh ball = solid("ball_10"), slab = solid("slab");
  exit_search search(ball, slab);
  const std::uint64_t seed = fresh_seed("ball in slab", "40 poses");
  numbers random(seed_of(seed, "ball in slab"));
  const double r = 10.0 * mm;
  const vec3 half(30.0 * mm, 30.0 * mm, 10.0 * mm);
  for (int i = 0; i < 40; ++i) {
    const vec3 c(random.between(-28.0, 28.0) * mm, random.between(-28.0, 28.0) * mm, random.between(-9.0, 19.0) * mm);
    double inside = half.z - std::fabs(c.z);
    for (int k = 0; k < 3; ++k) inside = std::min(inside, half[k] - std::fabs(c[k]));
    const double depth = r + inside;
    const way_out found =
        search.true_exit({random.turn(), c}, glm::normalize(vec3(random.between(-1.0, 1.0), 0.1, 1.0)));
    EXPECT_LE(found.way_m, 1.004 * depth) << "pose " << i;
    EXPECT_GE(found.way_m, depth - facets * r) << "pose " << i;
    EXPECT_NEAR(glm::length(found.direction_w), 1.0, 1e-12);
  }
  EXPECT_EQ(search.true_exit({quat(1, 0, 0, 0), {0.0, 0.0, 20.01 * mm}}, {0.0, 0.0, 1.0}).way_m, 0.0);
  EXPECT_TRUE(search.apart({quat(1, 0, 0, 0), {0.0, 0.0, 20.01 * mm}}));
  EXPECT_FALSE(search.apart({quat(1, 0, 0, 0), {0.0, 0.0, 19.9 * mm}}));
}

// Three walls: the way out has to leave each of them behind. A small ball goes the long way round for none of them.
TEST(true_exit, of_a_ball_in_a_concave_corner_leaves_all_three_walls) {
  const triangle_mesh ball = solid("ball_10"), corner = solid("corner");
  exit_search search(ball, corner);
  const std::uint64_t seed = fresh_seed("ball in corner", "20 poses");
  numbers random(seed_of(seed, "ball in corner"));
  for (int i = 0; i < 20; ++i) {
    const vec3 in(random.between(0.1, 3.0) * mm, random.between(0.1, 3.0) * mm, random.between(0.1, 3.0) * mm);
    const way_out found = search.true_exit({random.turn(), vec3(10.0 * mm) - in}, glm::normalize(vec3(1.0, 0.2, 0.1)));
    EXPECT_LE(found.way_m, 1.01 * glm::length(in)) << "pose " << i;
    EXPECT_GE(found.way_m, glm::length(in) - 2.0 * facets * 10.0 * mm) << "pose " << i;
    EXPECT_GT(glm::dot(found.direction_w, glm::normalize(in)), 0.99);
  }
}

// Not out to infinity, which leads through the other wall, but back into the hollow.
TEST(true_exit, of_a_ball_in_a_cup_leads_back_into_it) {
  exit_search search(solid("ball_2"), solid("cup"));
  const double wall = 18.0 * mm * std::cos(std::numbers::pi / 96.0);
  const way_out found =
      search.true_exit({quat(1, 0, 0, 0), {wall * std::cos(0.0327) - 1.5 * mm, 0.0, 20.0 * mm}}, {0, 0, 1});
  EXPECT_NEAR(found.way_m, 0.5 * mm, 0.03 * mm);
  EXPECT_LT(found.direction_w.x, -0.99);
}

// A body wholly within another crosses nothing and is not apart.
TEST(true_exit, of_a_ball_within_a_slab) {
  exit_search search(solid("ball_2"), solid("slab"));
  const way_out found = search.true_exit({quat(1, 0, 0, 0), {0.0, 0.0, 5.0 * mm}}, {0.6, 0.0, 0.8});
  EXPECT_NEAR(found.way_m, 7.0 * mm, 0.03 * mm);
  EXPECT_GT(found.direction_w.z, 0.995);
}

TEST(press_touch, of_a_ball_on_a_slab_is_what_its_closed_form_says) {
  const triangle_mesh ball = solid("ball_10"), slab = solid("slab");
  touch_finder finder("ball on slab", ball, slab);
  exit_search search(ball, slab);
  const int n = extent(40, 400);
  const std::uint64_t seed = fresh_seed("touches of ball on slab", std::to_string(n) + " touches");
  const vec3 half(30.0 * mm, 30.0 * mm, 10.0 * mm);
  int on_faces = 0;
  for (int i = 0; i < n; ++i) {
    const auto touch = finder.next(seed);
    ASSERT_TRUE(touch);
    const vec3 c = touch->touching_T_wa.position, away = c - glm::clamp(c, -half, half);
    EXPECT_NEAR(glm::length(away), 10.0 * mm, facets * 10.0 * mm);
    EXPECT_NEAR(glm::length(touch->point_w - glm::clamp(touch->point_w, -half, half)), 0.0, 1e-9);
    EXPECT_NEAR(glm::length(touch->out_w), 1.0, 1e-12);
    EXPECT_LE(glm::dot(touch->out_w, touch->way_w), -0.2);
    EXPECT_GT(glm::dot(touch->out_w, glm::normalize(away)), std::cos(0.05)) << "a facet's angle at most";
    EXPECT_TRUE(search.apart(touch->pressed(-1e-6)));
    EXPECT_FALSE(search.apart(touch->pressed(1e-4)));
    EXPECT_LE(touch->press_m, 8.0 * mm);
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = std::fabs(away[k]) > std::fabs(away[axis]) ? k : axis;
    bool by_an_edge = false;
    for (int k = 0; k < 3; ++k) by_an_edge = by_an_edge || (k != axis && std::fabs(c[k]) > half[k] - 1.0 * mm);
    if (by_an_edge) continue;
    ++on_faces;
    EXPECT_NEAR(std::fabs(touch->out_w[axis]), 1.0, 1e-9) << "the face's normal, whatever touches it";
    EXPECT_NEAR(touch->fixed_thickness_m, 2.0 * half[axis], 1e-9);
    EXPECT_NEAR(touch->probe_thickness_m, 20.0 * mm, 0.4 * mm);
    EXPECT_NEAR(touch->press_m, 8.0 * mm, 1e-9);
  }
  EXPECT_GT(on_faces, n / 10);
}

// Two crossed edges, or rather two rods of 128 sides: across both axes where their sides touch.
TEST(press_touch, of_crossed_rods_is_across_both) {
  const triangle_mesh rod = solid("rod_128");
  touch_finder finder("crossed rods", rod, rod, [](const vec3& a, const vec3& b) {
    return std::fabs(a.z) < 29.0 * mm && std::fabs(b.z) < 29.0 * mm;
  });
  const std::uint64_t seed = fresh_seed("crossed rods", "30 touches");
  for (int i = 0; i < 30; ++i) {
    const auto touch = finder.next(seed);
    ASSERT_TRUE(touch);
    const vec3 z(0.0, 0.0, 1.0), axis = touch->touching_T_wa.rotation * z;
    const double sine = glm::length(glm::cross(axis, z));
    EXPECT_LT(std::fabs(glm::dot(touch->out_w, z)), 1e-6);
    EXPECT_LT(std::fabs(glm::dot(touch->out_w, axis)), 1e-6);
    if (sine > 0.3) {
      EXPECT_GT(std::fabs(glm::dot(touch->out_w, glm::cross(axis, z) / sine)), 0.998);
    }
    EXPECT_NEAR(touch->fixed_thickness_m, 4.0 * mm, 0.1 * mm);
    EXPECT_NEAR(touch->press_m, 0.45 * std::min(touch->fixed_thickness_m, touch->probe_thickness_m), 1e-12);
  }
}

// Whichever edge is named first: what touches from below finds the normals of what lies above pointing down.
TEST(press_touch, faces_the_approach_whatever_touches) {
  const triangle_mesh cone = make_press_solid("cone_45_4", fineness::plain).value();
  oracle::approach_sampler sampler("edges on edges", cone, cone);
  const std::uint64_t seed = fresh_seed("edges on edges", "60 approaches");
  for (std::uint64_t i = 0; i < 60; ++i) {
    const oracle::approach on = sampler.draw(seed, i);
    EXPECT_NEAR(glm::length(on.out_w), 1.0, 1e-12);
    EXPECT_LT(glm::dot(on.out_w, on.window.n_ab_w), 1e-12) << "approach " << i;
  }
}

// A touch that is repeated by its number, and regions that pairs ask for.
TEST(press_touch, is_repeatable_and_in_its_region) {
  for (const press_pair& pair : press_pairs()) {
    if (!pair.region || !test_support::is_press_solid(pair.probe) || !test_support::is_press_solid(pair.fixed))
      continue;
    const triangle_mesh a = solid(pair.probe.c_str()), b = solid(pair.fixed.c_str());
    const std::uint64_t seed = fresh_seed(pair.name(), "3 touches");
    touch_finder finder(pair.name(), a, b, pair.region), again(pair.name(), a, b, pair.region);
    for (int i = 0; i < 3; ++i) {
      const auto touch = finder.next(seed);
      ASSERT_TRUE(touch) << pair.name();
      EXPECT_TRUE(pair.region(inverse(touch->touching_T_wa) * touch->point_w, touch->point_w));
      const auto twin = again.at(seed, touch->index);
      ASSERT_TRUE(twin);
      EXPECT_EQ(twin->touching_T_wa.position, touch->touching_T_wa.position);
      EXPECT_EQ(twin->out_w, touch->out_w);
    }
  }
}

}  // namespace
}  // namespace asperity::presses
