// The joint step against the step of one body, and against the conditions that its answer has to fulfil.
#include "bodies/joint_solver.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "asperity/control/contact_solver.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

mat6 drawn_inertia(drawn& d) {
  mat6 out;
  const double m = d.log_between(1.0, 1e4);
  for (std::size_t i = 0; i < 6; ++i) out(i, i) = i < 3 ? m : 1e-4 * m * d.between(0.5, 2.0);
  add_outer(out, 0.1 * m, {d.inside(1.0), d.inside(0.01)});
  return out;
}

TEST(joint_solver, agrees_with_the_solver_of_one_body) {
  drawn d(seed_of(fresh_seed("joint_solver", "500 steps of one body"), "one"));
  detail::joint_solver solver(1, most_support_planes);
  int pressed = 0;
  for (int i = 0; i < 500; ++i) {
    const std::vector<mat6> a{drawn_inertia(d)};
    const std::vector<vec6> load{{d.inside(20.0), d.inside(0.3)}}, v0{{d.inside(0.3), d.inside(3.0)}};
    support_planes planes;
    std::vector<detail::joint_plane> joint;
    const double h_s = 2.5e-4;
    const contact_law law{.stiffness_n_per_m = d.log_between(1e3, 1e6), .dissipation_s_per_m = d.between(0.0, 10.0)};
    for (int n = 1 + static_cast<int>(d.between(0.0, 12.0)); n > 0; --n) {
      const vec3 normal = d.direction(), r = d.inside(0.02);
      const support_plane p{
          .depth_m = d.between(-5e-5, 5e-5), .gradient = {normal, glm::cross(r, normal)}, .n_ab_w = normal, .r_w = r};
      ASSERT_TRUE(planes.push_back(p));
      joint.push_back({.a = 0,
                       .gradient_a = p.gradient,
                       .depth_m = p.depth_m,
                       .stiffness_n_per_m = law.stiffness_n_per_m,
                       .horizon_s = h_s + 1.5 * law.dissipation_s_per_m * std::max(0.0, p.depth_m)});
    }
    const contact_solution one = solve_contact(a[0], load[0], v0[0], h_s, planes, {}, law);
    std::vector<vec6> v(1);
    const detail::joint_answer all = solver.solve(a, load, v0, joint, {}, v);
    ASSERT_TRUE(one.solved && all.solved);
    EXPECT_LT(glm::length(v[0].linear - one.velocity.linear), 1e-9);
    EXPECT_LT(glm::length(v[0].angular - one.velocity.angular), 1e-7);
    for (std::size_t n = 0; n < joint.size(); ++n) {
      EXPECT_NEAR(joint[n].lambda_n, one.lambda_n[n], 1e-6 * (1.0 + one.lambda_n[n]));
      pressed += joint[n].lambda_n > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(pressed, 500);
}

// Chains, trees and rings of bodies with springs: what the answer has to fulfil, computed anew from it.
TEST(joint_solver, balances_bodies_that_touch) {
  drawn d(seed_of(fresh_seed("joint_solver", "200 steps of 2 to 12 bodies"), "many"));
  detail::joint_solver solver(12, 256);
  for (int i = 0; i < 200; ++i) {
    const auto n = static_cast<std::uint32_t>(2 + d.bits() % 11U);
    std::vector<mat6> a;
    std::vector<vec6> load, v0, v(n);
    for (std::uint32_t b = 0; b < n; ++b) {
      a.push_back(drawn_inertia(d));
      load.push_back({d.inside(20.0), d.inside(0.3)});
      v0.push_back({d.inside(0.3), d.inside(3.0)});
    }
    std::vector<detail::joint_plane> planes;
    std::vector<detail::joint_spring> springs;
    const auto other_of = [&](std::uint32_t b) {
      const auto other = static_cast<std::uint32_t>(d.bits() % (n + 1));
      return other == n || other == b ? detail::unmoved : other;
    };
    for (std::uint32_t p = 0; p < 6 * n; ++p) {
      detail::joint_plane of{.a = p % n, .b = other_of(p % n)};
      const vec3 normal = d.direction();
      of.gradient_a = {normal, glm::cross(d.inside(0.02), normal)};
      of.gradient_b = {-normal, glm::cross(d.inside(0.02), -normal)};
      of.depth_m = d.between(-1e-4, 1e-4);
      of.stiffness_n_per_m = d.log_between(1e3, 1e6);
      of.horizon_s = 2.5e-4 + 1e-3 * std::max(0.0, of.depth_m);
      planes.push_back(of);
    }
    for (std::uint32_t s = 0; s < n; ++s) {
      detail::joint_spring of{.a = s, .b = other_of(s), .horizon_s = 1e-3, .arm_w = d.inside(0.03)};
      for (int k = 0; k < 3; ++k) add_outer(of.matrix, d.log_between(1e3, 1e5), {d.inside(1.0), d.inside(0.02)});
      of.stretch = {d.inside(1e-4), d.inside(1e-3)};
      springs.push_back(of);
    }
    ASSERT_TRUE(solver.solve(a, load, v0, planes, springs, v).solved);
    std::vector<vec6> off(n);
    double size_n = 1.0;
    for (std::uint32_t b = 0; b < n; ++b) off[b] = a[b] * (v[b] - v0[b]) - load[b];
    for (const detail::joint_plane& p : planes) {
      double x = p.depth_m + p.horizon_s * dot(p.gradient_a, v[p.a]);
      if (p.b != detail::unmoved) x += p.horizon_s * dot(p.gradient_b, v[p.b]);
      EXPECT_NEAR(p.lambda_n, p.stiffness_n_per_m * std::max(0.0, x), 1e-6 * (1.0 + p.lambda_n));
      off[p.a] += p.lambda_n * p.gradient_a;
      if (p.b != detail::unmoved) off[p.b] += p.lambda_n * p.gradient_b;
      size_n = std::max(size_n, p.lambda_n);
    }
    for (const detail::joint_spring& s : springs) {
      vec6 slide = v[s.a];
      if (s.b != detail::unmoved) {
        const vec6& o = v[s.b];
        slide = slide - vec6{o.linear + glm::cross(o.angular, s.arm_w), o.angular};
      }
      const wrench on_a = to_wrench(-1.0 * (s.matrix * (s.stretch + s.horizon_s * slide)));
      off[s.a] = off[s.a] - to_vec6(on_a);
      if (s.b != detail::unmoved) off[s.b] += to_vec6(transport(on_a, s.arm_w, vec3(0.0)));
    }
    for (std::uint32_t b = 0; b < n; ++b) {
      EXPECT_LT(glm::length(off[b].linear), 1e-7 * size_n);
      EXPECT_LT(glm::length(off[b].angular), 1e-7 * size_n);
    }
  }
}

}  // namespace
