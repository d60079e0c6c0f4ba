#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include <asperity/control/probe.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double pi = 3.141592653589793;

virtual_coupling undamped(double kt, double kr) {
  // A damping cannot be zero by configuration (zero asks for critical): take one that dissipates nothing measurable.
  return {{.stiffness_n_per_m = kt,
           .stiffness_n_m_per_rad = kr,
           .damping_n_s_per_m = 1e-300,
           .damping_n_m_s_per_rad = 1e-300},
          0.01,
          1e-5};
}

double unit(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

// Implicit Euler multiplies an undamped oscillation by 1/(1 - i w h) each step: amplitude and phase are known exactly.
TEST(probe, follows_the_oscillator_of_the_implicit_step) {
  const double mass = 0.01;
  const double k = 500.0;
  const double h = 1e-5;
  const double w = std::sqrt(k / mass);
  probe p({mass, mat3(1e-5)});
  p.reset({quat(1, 0, 0, 0), {0.001, 0, 0}});
  const virtual_coupling spring = undamped(k, 3.0);
  const int steps = 5000;
  for (int i = 0; i < steps; ++i) ASSERT_EQ(p.step(h, spring, {}, {}, {}), status::ok);
  const double decay = std::pow(1.0 + w * w * h * h, -0.5 * steps);
  const double phase = steps * std::atan(w * h);
  EXPECT_NEAR(p.state().T_wc.position.x, 0.001 * decay * std::cos(phase), 1e-6 * 0.001);
  EXPECT_NEAR(p.state().T_wc.position.x, 0.001 * std::cos(w * h * steps), 0.001 * 0.14);  // and the true one nearly
}

TEST(probe, turns_as_it_moves) {
  const double inertia = 1e-5;
  const double h = 1e-5;
  const double w = std::sqrt(3.0 / inertia);
  probe p({0.01, mat3(inertia)});
  p.reset({exp_rotation({0, 0.1, 0}), vec3(0.0)});
  const virtual_coupling spring = undamped(500.0, 3.0);
  const int steps = 1000;
  for (int i = 0; i < steps; ++i) ASSERT_EQ(p.step(h, spring, {}, {}, {}), status::ok);
  const double decay = std::pow(1.0 + w * w * h * h, -0.5 * steps);
  EXPECT_NEAR(log_rotation(p.state().T_wc.rotation).y, 0.1 * decay * std::cos(steps * std::atan(w * h)), 1e-6);
}

TEST(probe, converges_to_the_true_oscillator_with_the_first_order) {
  const double w = std::sqrt(500.0 / 0.01);
  const double end = 0.02;
  double last = 0.0;
  for (int steps : {1000, 2000, 4000}) {
    probe p({0.01, mat3(1e-5)});
    p.reset({quat(1, 0, 0, 0), {0.001, 0, 0}});
    for (int i = 0; i < steps; ++i) ASSERT_EQ(p.step(end / steps, undamped(500.0, 3.0), {}, {}, {}), status::ok);
    const double error = std::fabs(p.state().T_wc.position.x - 0.001 * std::cos(w * end));
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 2.0, 0.1);
    }
    last = error;
  }
}

// The probe's inertia belongs to its body: turned by a quarter about z, x and y change places.
TEST(probe, carries_its_inertia_with_its_rotation) {
  mat3 inertia(1e-5);
  inertia[0][0] = 4e-5;
  const virtual_coupling spring = undamped(500.0, 3.0);
  const auto response_about_x = [&](double turn) {
    probe p({0.01, inertia});
    p.reset({exp_rotation({0, 0, turn}), vec3(0.0)});
    const pose target{p.state().T_wc.rotation, vec3(0.0)};
    EXPECT_EQ(p.step(1e-6, spring, target, {}, {}, {vec3(0.0), {1e-3, 0, 0}}), status::ok);
    return p.state().velocity_w.angular.x;
  };
  EXPECT_NEAR(response_about_x(0.0), 1e-3 * 1e-6 / 4e-5, 1e-9);
  EXPECT_NEAR(response_about_x(0.5 * pi), 1e-3 * 1e-6 / 1e-5, 1e-9);
}

// About any axis of any body: a torque about a principal axis, wherever the body has turned it, turns the body about
// that axis, by the moment of that axis. Turned by quarters the sense of the rotation would not show.
TEST(probe, turns_about_its_own_axes_however_it_lies) {
  mat3 inertia(0.0);
  const vec3 moments{1e-5, 3e-5, 9e-5};
  for (int i = 0; i < 3; ++i) inertia[i][i] = moments[i];
  const virtual_coupling spring = undamped(500.0, 3.0);
  std::mt19937_64 bits(11);
  for (int n = 0; n < 20; ++n) {
    const vec3 turn{3.0 * unit(bits) - 1.5, 3.0 * unit(bits) - 1.5, 3.0 * unit(bits) - 1.5};
    for (int axis = 0; axis < 3; ++axis) {
      probe p({0.01, inertia});
      p.reset({exp_rotation(turn), vec3(0.0)});
      const pose target = p.state().T_wc;
      vec3 along_a{0.0};
      along_a[axis] = 1.0;
      const vec3 along_w = exp_rotation(turn) * along_a;
      ASSERT_EQ(p.step(1e-6, spring, target, {}, {}, {vec3(0.0), 1e-3 * along_w}), status::ok);
      const vec3 expected = 1e-3 * 1e-6 / moments[axis] * along_w;
      EXPECT_LT(glm::length(p.state().velocity_w.angular - expected), 1e-6 * glm::length(expected)) << n << ' ' << axis;
      EXPECT_NEAR(p.kinetic_j(), 0.5 * moments[axis] * glm::dot(expected, expected), 1e-5 * p.kinetic_j());
    }
  }
}

struct stiff_scene {
  probe tool;
  virtual_coupling coupling{{}, 0.01, 1e-5};
  linear_contact contact;

  // Up to six random directions with stiffnesses between 1 and 1e12.
  stiff_scene(std::mt19937_64& bits, int directions, std::size_t axes) {
    for (int i = 0; i < directions; ++i) {
      vec6 g;
      for (std::size_t j = 0; j < axes; ++j) g[j] = (2.0 * unit(bits) - 1.0) * (j < 3 ? 1.0 : 0.03);
      add_outer(contact.stiffness, -std::pow(10.0, 12.0 * unit(bits)), g);
    }
    tool.reset({axes == 6 ? exp_rotation({0.002, -0.001, 0.003}) : quat(1, 0, 0, 0), {0.001, -0.002, 0.003}});
  }
  [[nodiscard]] status step() { return tool.step(1e-3, coupling, {}, {}, evaluate(contact, tool.state().T_wc)); }
  [[nodiscard]] double energy_j() const {
    const vec6 q = pose_difference(tool.state().T_wc, {});
    return tool.kinetic_j() + coupling.stored_j({}, tool.state().T_wc) - 0.5 * dot(q, contact.stiffness * q);
  }
};

// Any symmetric negative semidefinite J, of any size: kinetic energy, springs and contact potential together only fall.
TEST(probe, loses_energy_under_any_contact_stiffness) {
  std::mt19937_64 bits(7);
  for (int trial = 0; trial < 200; ++trial) {
    stiff_scene s(bits, 1 + trial % 6, 3);
    double before = s.energy_j();
    for (int i = 0; i < 300; ++i) {
      ASSERT_EQ(s.step(), status::ok);
      ASSERT_LE(s.energy_j(), before * (1.0 + 1e-9)) << "trial " << trial << " step " << i;
      before = s.energy_j();
    }
  }
}

// With rotations the potential is quadratic in the pose only to first order: it may wobble, and stays below its start.
TEST(probe, stays_bounded_under_any_six_dimensional_stiffness) {
  std::mt19937_64 bits(8);
  for (int trial = 0; trial < 200; ++trial) {
    stiff_scene s(bits, 1 + trial % 6, 6);
    const double start = s.energy_j();
    for (int i = 0; i < 300; ++i) {
      ASSERT_EQ(s.step(), status::ok);
      ASSERT_LE(s.energy_j(), start) << "trial " << trial << " step " << i;
    }
    EXPECT_LT(s.energy_j(), 0.01 * start);
  }
}

TEST(probe, explodes_without_the_stiffness_in_the_step) {  // the test of the test above
  probe p;
  p.reset({quat(1, 0, 0, 0), {0, 0, 0.001}});
  const virtual_coupling coupling({}, 0.01, 1e-5);
  double farthest = 0.0;
  for (int i = 0; i < 50 && farthest < 1.0; ++i) {
    contact_evaluation held;
    held.on_probe_w.force.z = -1e6 * p.state().T_wc.position.z;
    if (p.step(1e-3, coupling, {}, {}, held) != status::ok) farthest = std::numeric_limits<double>::infinity();
    farthest = std::max(farthest, std::fabs(p.state().T_wc.position.z));
  }
  EXPECT_GE(farthest, 1.0);
}

TEST(probe, closes_its_energy_book) {
  probe p({0.01, mat3(1e-5)});
  p.reset({});
  const virtual_coupling coupling({}, 0.01, 1e-5);
  linear_contact wall;
  wall.stiffness(2, 2) = -2000.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 1e-4;
    const pose target{exp_rotation({0.1 * std::sin(30 * t), 0.05 * std::sin(50 * t), 0}),
                      {0.01 * std::sin(20 * t), 0, -0.002 * std::sin(40 * t)}};
    ASSERT_EQ(p.step(1e-4, coupling, target, {}, evaluate(wall, p.state().T_wc), {{0.1, 0, 0}, vec3(0.0)}), status::ok);
  }
  const probe_energy& e = p.energy();
  const double gained = e.by_coupling_j + e.by_contact_j + e.by_external_j - e.numerical_j;
  EXPECT_NEAR(gained, p.kinetic_j(), 1e-12);
  EXPECT_GT(std::fabs(e.by_coupling_j), 1e-4);  // the balance is not between zeros
  EXPECT_GE(e.numerical_j, 0.0);
}

TEST(probe, stops_where_a_load_is_not_finite) {
  probe p;
  p.reset({quat(1, 0, 0, 0), {0, 0, 0.001}});
  const virtual_coupling coupling({}, 0.01, 1e-5);
  ASSERT_EQ(p.step(1e-3, coupling, {}, {}, {}), status::ok);
  const pose before = p.state().T_wc;
  contact_evaluation bad;
  bad.on_probe_w.force.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(p.step(1e-3, coupling, {}, {}, bad), status::not_finite);
  EXPECT_EQ(p.state().T_wc.position, before.position);
  EXPECT_EQ(p.state().velocity_w.linear, vec3(0.0));
}

TEST(virtual_coupling, is_critically_damped_up_to_its_bound) {
  EXPECT_DOUBLE_EQ(virtual_coupling({}, 0.01, 1e-5).damping_n_s_per_m(), 2.0 * std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(virtual_coupling({}, 0.01, 1e-5).damping_n_m_s_per_rad(), 2.0 * std::sqrt(3e-5));
  EXPECT_EQ(virtual_coupling({}, 1.0, 1.0).damping_n_s_per_m(), 5.0);
  EXPECT_EQ(virtual_coupling({.damping_n_s_per_m = 0.7}, 1.0, 1.0).damping_n_s_per_m(), 0.7);
}

// Each of the four terms by itself, with every velocity that it is made of.
TEST(virtual_coupling, is_two_springs_and_two_dampers) {
  const virtual_coupling c({.stiffness_n_per_m = 400.0,
                            .stiffness_n_m_per_rad = 2.0,
                            .damping_n_s_per_m = 3.0,
                            .damping_n_m_s_per_rad = 0.05},
                           0.01, 1e-5);
  const pose here{exp_rotation({0, 0, 0.1}), {0.001, 0.002, 0.003}};
  const pose there{exp_rotation({0, 0, 0.3}), {0.004, 0.002, 0.001}};
  const twist still{};
  const twist moving{{0.1, -0.2, 0.3}, {1.0, -2.0, 3.0}};
  const wrench springs = c.on_probe(there, still, here, still);
  EXPECT_LT(glm::length(springs.force - vec3(1.2, 0.0, -0.8)), 1e-14);
  EXPECT_LT(glm::length(springs.torque - vec3(0.0, 0.0, 0.4)), 1e-14);
  const wrench pulled = c.on_probe(here, moving, here, still);
  EXPECT_LT(glm::length(pulled.force - 3.0 * moving.linear), 1e-14);
  EXPECT_LT(glm::length(pulled.torque - 0.05 * moving.angular), 1e-14);
  const wrench held = c.on_probe(here, still, here, moving);
  EXPECT_LT(glm::length(held.force + 3.0 * moving.linear), 1e-14);
  EXPECT_LT(glm::length(held.torque + 0.05 * moving.angular), 1e-14);
}

TEST(virtual_coupling, pulls_the_probe_towards_the_device) {
  const virtual_coupling c({}, 0.01, 1e-5);
  const wrench w = c.on_probe({exp_rotation({0, 0, 0.1}), {0.001, 0, 0}}, {}, {}, {});
  EXPECT_DOUBLE_EQ(w.force.x, 0.5);
  EXPECT_NEAR(w.torque.z, 0.3, 1e-12);
  const wrench drag = c.on_probe({}, {}, {}, {{1.0, 0, 0}, vec3(0.0)});
  EXPECT_DOUBLE_EQ(drag.force.x, -c.damping_n_s_per_m());
}

// Springs that want out of what is known: the probe stays in it, the border takes energy and gives none, whatever its
// shape and the probe's inertia are.
TEST(probe, the_border_of_what_is_known_only_takes_energy) {
  drawn d(seed_of(fresh_seed("probe, border", "300 probes"), "border"));
  double taken_j = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double arm_m = d.log_between(0.01, 0.1);
    const double inertia = 0.01 * arm_m * arm_m * d.log_between(0.01, 1.0);
    probe p({0.01, mat3(inertia)});
    known_region within{{exp_rotation(d.inside(1.0)), d.inside(0.1)}, {d.log_between(1e-4, 2e-3), 0.0}};
    within.known.turn_rad = within.known.way_m / arm_m;
    const auto somewhere = [&](double share) {
      const vec3 way = within.known.way_m * d.inside(share), turn = within.known.turn_rad * d.inside(share);
      return pose{exp_rotation(turn) * within.T_wc.rotation, within.T_wc.position + way};
    };
    const bool outside = i % 4 == 0;  // a newer contact may know less of where the probe is
    p.reset(somewhere(outside ? 2.0 : 0.5));
    const virtual_coupling coupling({.stiffness_n_per_m = d.log_between(100, 5e3),
                                     .stiffness_n_m_per_rad = d.log_between(0.1, 20),
                                     .damping_n_s_per_m = d.log_between(1e-3, 5),
                                     .damping_n_m_s_per_rad = d.log_between(1e-6, 0.05)},
                                    0.01, inertia);
    linear_contact wall;
    wall.T_wc = within.T_wc;
    wall.stiffness(2, 2) = -d.log_between(10, 1e4);
    for (int hop = 0; hop < 10; ++hop) {
      const pose target = somewhere(3.0);
      double energy_j = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 40; ++k) {
        const double share_before = within.known.share(pose_difference(p.state().T_wc, within.T_wc));
        const double border_before_j = p.energy().by_border_j;
        ASSERT_EQ(p.step(1.25e-4, coupling, target, {},
                         hop % 2 == 0 ? contact_evaluation{} : evaluate(wall, p.state().T_wc), {}, within),
                  status::ok);
        const double share = within.known.share(pose_difference(p.state().T_wc, within.T_wc));
        ASSERT_LE(share, std::max(1.0, share_before) + 1e-9) << i;
        ASSERT_LE(p.energy().by_border_j, border_before_j + 1e-15) << i;
        if (hop % 2 != 0) continue;
        const double now_j = p.kinetic_j() + coupling.stored_j(target, p.state().T_wc);
        ASSERT_LE(now_j, energy_j * (1.0 + 1e-9) + 1e-12) << i << ' ' << hop << ' ' << k;
        energy_j = now_j;
      }
    }
    const probe_energy& e = p.energy();
    const double gained = e.by_coupling_j + e.by_contact_j + e.by_external_j + e.by_border_j - e.numerical_j;
    EXPECT_NEAR(gained, p.kinetic_j(), 1e-9 * (1.0 + std::fabs(e.by_coupling_j))) << i;
    taken_j -= e.by_border_j;
  }
  EXPECT_GT(taken_j, 1e-3);
}

}  // namespace
