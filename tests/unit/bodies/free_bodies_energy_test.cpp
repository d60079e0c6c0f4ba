// Where the energy of free bodies goes: no step makes any, and what is free keeps its momentum.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <vector>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/bodies/block_scene.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

struct momenta {
  vec3 linear{0.0}, angular{0.0};
};

momenta momenta_of(const free_bodies& bodies, const model_ptr& model) {
  momenta out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double m = bodies.mass_kg(i);
    const mat3 r = glm::mat3_cast(bodies.T_wb(i).rotation);
    const twist v = bodies.velocity_w(i);
    const vec3 p = m * v.linear;
    out.linear += p;
    out.angular += glm::cross(bodies.T_wb(i) * model->mass.centre_of_mass, p) +
                   m * (r * model->mass.inertia_per_mass * glm::transpose(r)) * v.angular;
  }
  return out;
}

// Without gravity and damping blocks fly into each other and rub: momentum stays, energy only falls.
TEST(free_bodies_energy, is_never_made_and_momentum_stays) {
  drawn d(seed_of(fresh_seed("free_bodies_energy", "4 collisions of 3 blocks, 30 at length"), "collide"));
  const model_ptr block = box_with({0.012, 0.008, 0.006}, 0.7);
  int met = 0;
  for (int i = 0; i < extent(4, 30); ++i) {
    free_bodies_settings s = quick_settings();
    s.gravity_m_per_s2 = vec3(0.0);
    s.linear_damping_per_s = s.angular_damping_per_s = 0.0;
    s.sleep_after_s = 0.0;
    free_scene scene;
    const double masses_kg = d.log_between(0.01, 1.0);
    for (int n = 0; n < 3; ++n) {
      scene.free.push_back({.model = block,
                            .T_wb = {exp_rotation(d.inside(3.0)), {0.035 * (n - 1), 0.0, 0.0}},
                            .mass_kg = masses_kg * d.log_between(0.3, 3.0)});
    }
    free_bodies bodies = made(scene, s);
    for (std::size_t n = 0; n < 3; ++n) {
      ASSERT_TRUE(bodies.put(n, scene.free[n].T_wb,
                             {vec3(-0.3 * (static_cast<double>(n) - 1.0), 0.0, 0.0) + d.inside(0.05), d.inside(3.0)}));
    }
    bodies.advance(1e-3);
    const momenta before = momenta_of(bodies, block);
    const double size = bodies.mass_kg(0) * 0.3, given_j = bodies.energy().kinetic_j;
    for (int n = 0; n < 300; ++n) {
      bodies.advance(1e-3);
      ASSERT_EQ(bodies.last(), status::ok);
    }
    const momenta after = momenta_of(bodies, block);
    const bodies_energy& e = bodies.energy();
    met += e.kinetic_j < 0.95 * given_j ? 1 : 0;
    EXPECT_LT(glm::length(after.linear - before.linear), 1e-9 * size);
    // Angular momentum of a body that turns freely is kept to the order of the step.
    EXPECT_LT(glm::length(after.angular - before.angular), 2e-3 * size * 0.035);
    EXPECT_LT(e.most_made_j, 1e-15);
    EXPECT_LE(e.kinetic_j, given_j + std::max(0.0, e.by_rendering_j) + 1e-12);
  }
  EXPECT_GT(met, 0) << "none collided";
}

// A body that tumbles about its middle axis turns over, and no step gives it energy.
TEST(free_bodies_energy, of_a_tumbling_body_only_falls) {
  drawn d(seed_of(fresh_seed("free_bodies_energy", "10 bodies tumble"), "tumble"));
  const model_ptr block = box_with({0.012, 0.008, 0.004}, 0.0);
  free_bodies_settings s = quick_settings();
  s.gravity_m_per_s2 = vec3(0.0);
  s.linear_damping_per_s = s.angular_damping_per_s = s.sleep_after_s = 0.0;
  free_bodies bodies = made({.free = {{.model = block}}}, s);
  for (int i = 0; i < 10; ++i) {
    const quat turned = exp_rotation(d.inside(3.0));
    const vec3 middle_axis = turned * vec3(0.01, 1.0, 0.01);
    ASSERT_TRUE(bodies.put(0, {turned, vec3(0.0)}, {vec3(0.0), d.between(5.0, 20.0) * middle_axis}));
    const double lost_before_j = bodies.energy().lost_j;
    bodies.advance(1e-3);
    const double first_j = bodies.energy().kinetic_j;
    double last_j = first_j, least_cosine = 1.0;
    bool grew = false;
    for (int n = 0; n < 3000; ++n) {
      bodies.advance(1e-3);
      grew = grew || bodies.energy().kinetic_j > last_j * (1.0 + 1e-12);
      last_j = bodies.energy().kinetic_j;
      const vec3 axis_now = bodies.T_wb(0).rotation * vec3(0.0, 1.0, 0.0);
      least_cosine = std::min(least_cosine, glm::dot(axis_now, glm::normalize(middle_axis)));
    }
    EXPECT_FALSE(grew);
    EXPECT_GT(last_j, 0.5 * first_j) << "the implicit step takes a little";
    EXPECT_LT(least_cosine, 0.0) << "it never turned over";
    EXPECT_GE(bodies.energy().lost_j, lost_before_j);
  }
}

// Steps with everything at once, told seldom and often: the book closes and the most that a step made is rounding.
TEST(free_bodies_energy, closes_its_book) {
  drawn d(seed_of(fresh_seed("free_bodies_energy", "2 scenes of 4 blocks and a hand, 20 at length"), "book"));
  for (int i = 0; i < extent(2, 20); ++i) {
    free_bodies_settings s = quick_settings();
    s.render_every = 1 + static_cast<int>(d.between(0.0, 4.0));
    s.substeps = 1 + static_cast<int>(d.between(0.0, 8.0));
    s.contact.dissipation_s_per_m = d.between(0.0, 10.0);
    s.coupling.stiffness_n_per_m = d.log_between(200.0, 5000.0);
    const model_ptr block = box_with(block_half_m, d.between(0.0, 1.0), ridges(3e-5, 0.003));
    free_scene scene{.probe = box_with(finger_half_m, 0.5), .standing = {{box_with(table_of_blocks_half_m, 1.0)}}};
    for (int n = 0; n < 4; ++n) {
      scene.free.push_back({.model = block,
                            .T_wb = {exp_rotation(d.inside(3.0)),
                                     {0.046 * (n % 2) - 0.023, 0.046 * (n / 2) - 0.023, block_at_rest_m + 0.015}},
                            .mass_kg = d.log_between(0.01, 1.0)});
    }
    free_bodies bodies = made(scene, s);
    pose T_wh{quat(1, 0, 0, 0), {-0.05, 0.0, block_at_rest_m}};
    bodies.place(T_wh);
    const double speed = d.between(0.02, 0.2);
    for (int n = 0; n < 600; ++n) {
      T_wh.position = {-0.05 + 0.08 * std::sin(speed * 20.0 * n * 1e-3), 0.02 * std::sin(0.01 * n), block_at_rest_m};
      static_cast<void>(bodies.follow(T_wh, 1e-3));
      ASSERT_NE(bodies.last(), status::not_finite);
    }
    const bodies_energy& e = bodies.energy();
    const double given_j = e.by_gravity_j + e.by_hand_j + e.by_pushes_j + e.by_rendering_j;
    const double kept_j = e.kinetic_j + e.springs_j + e.bristles_j + e.lost_j;
    std::printf(
        "  %.0f mJ given by the hand, %.1f mJ by gravity, %.2f mJ by rendering; %.1f mJ lost; most made %.1e J\n",
        1e3 * e.by_hand_j, 1e3 * e.by_gravity_j, 1e3 * e.by_rendering_j, 1e3 * e.lost_j, e.most_made_j);
    EXPECT_NEAR(given_j, kept_j, 1e-9 + 1e-9 * std::fabs(e.lost_j));
    EXPECT_LT(e.most_made_j, 1e-15);
  }
}

}  // namespace
