// A handle that lets go of its probe and takes it up again, in a world of any scale: no step, no energy, no drift.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include <asperity/planes/plane_renderer.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr std::int64_t one_ms = 1'000'000;

TEST(clutch, does_the_same_work_on_both_sides) {
  drawn d(seed_of(fresh_seed("clutch", "50 walks of 2000 ticks"), "work"));
  int all_went_over = 0;
  for (int i = 0; i < 50; ++i) {
    const workspace_map map{
        {exp_rotation(d.inside(3.0)), d.inside(1.0)}, d.log_between(0.1, 10.0), {exp_rotation(d.inside(1.0)), {}}};
    clutched_map clutch(map, {.buttons = 1, .ramp_s = d.between(0.03, 0.3)});
    pose T_dh{exp_rotation(d.inside(1.0)), d.inside(0.1)};
    static_cast<void>(clutch.follow(T_dh, false, 0.0));
    clutch.take_up(T_dh);
    double at_device_j = 0.0, in_world_j = 0.0, turnover_j = 0.0;
    bool let_go = false;
    int went_over = 0;
    for (int k = 0; k < 2000; ++k) {
      if (d.between(0.0, 1.0) < 0.005) let_go = !let_go;
      const wrench on_hand_w{d.inside(20.0), d.inside(1.0)};
      const pose before_w = clutch.T_wh();
      const vec3 point_w = before_w.position + d.inside(0.1);
      const wrench on_hand_d = clutch.to_device(on_hand_w, point_w);
      const vec3 moved_d = d.inside(1e-3), turned_d = d.inside(1e-2);
      T_dh = {glm::normalize(exp_rotation(turned_d) * T_dh.rotation), T_dh.position + moved_d};
      went_over += clutch.follow(T_dh, let_go, 1e-3) ? 1 : 0;
      const vec3 moved_w = clutch.T_wh().position - before_w.position;
      const vec3 turned_w = log_rotation(clutch.T_wh().rotation * glm::conjugate(before_w.rotation));
      at_device_j += glm::dot(on_hand_d.force, moved_d) + glm::dot(on_hand_d.torque, turned_d);
      const wrench about_handle = transport(on_hand_w, point_w, before_w.position);
      in_world_j += glm::dot(about_handle.force, moved_w) + glm::dot(about_handle.torque, turned_w);
      turnover_j += std::fabs(glm::dot(on_hand_d.force, moved_d)) + std::fabs(glm::dot(on_hand_d.torque, turned_d));
    }
    all_went_over += went_over;
    EXPECT_NEAR(at_device_j, in_world_j, 1e-10 * turnover_j);
  }
  EXPECT_GT(all_went_over, 50);
}

TEST(clutch, moves_nothing_that_is_let_go_and_drifts_nowhere) {
  drawn d(seed_of(fresh_seed("clutch_drift", "one walk of 200 times"), "drift"));
  const workspace_map map{{exp_rotation({0.4, -1.0, 0.3}), {0.1, 0.2, -0.3}}, 2.5, {}};
  clutched_map clutch(map, {.buttons = 1});
  pose T_dh{quat(1, 0, 0, 0), {0.1, 0, 0}};
  static_cast<void>(clutch.follow(T_dh, false, 0.0));
  clutch.take_up(T_dh);
  for (int round = 0; round < 200; ++round) {
    for (int k = 0; k < 300; ++k) {
      T_dh = {glm::normalize(exp_rotation(d.inside(0.01)) * T_dh.rotation), T_dh.position + d.inside(1e-3)};
      static_cast<void>(clutch.follow(T_dh, true, 1e-3));
      EXPECT_TRUE(k < 151 || clutch.ratio() == 0.0);
    }
    const pose rests = clutch.T_wh();
    T_dh.position += d.inside(0.2);
    static_cast<void>(clutch.follow(T_dh, true, 1e-3));
    EXPECT_EQ(clutch.T_wh().position, rests.position);
    EXPECT_EQ(clutch.to_device({{1, 2, 3}, {4, 5, 6}}, {}).force, vec3(0.0));
    for (int k = 0; k < 152; ++k) static_cast<void>(clutch.follow(T_dh, false, 1e-3));
    ASSERT_EQ(clutch.ratio(), 1.0);
    EXPECT_LT(glm::length(clutch.T_wh().position - rests.position), 1e-12);
    // In the hand again: the whole motion, and back to the same place to the rounding of a sum.
    const pose taken = clutch.T_wh();
    const vec3 way = d.inside(0.1);
    static_cast<void>(clutch.follow({T_dh.rotation, T_dh.position + way}, false, 1e-3));
    EXPECT_LT(glm::length(clutch.T_wh().position - taken.position - 2.5 * (map.T_wd.rotation * way)), 1e-12);
    static_cast<void>(clutch.follow(T_dh, false, 1e-3));
    EXPECT_LT(glm::length(clutch.T_wh().position - taken.position), 1e-13);
    EXPECT_TRUE(is_valid(clutch.T_wh()));
  }
}

TEST(clutch, that_is_none_is_the_map_to_the_bit) {
  drawn d(seed_of(fresh_seed("clutch_none", "200 poses"), "none"));
  const workspace_map map{{exp_rotation({0.4, -1.0, 0.3}), {0.1, 0.2, -0.3}}, 1.7, {}};
  clutched_map clutch(map);
  for (int i = 0; i < 200; ++i) {
    const pose T_dh{exp_rotation(d.inside(1.0)), d.inside(0.1)};
    EXPECT_FALSE(clutch.follow(T_dh, true, 1e-3));
    if (i == 0) clutch.take_up(T_dh);
    EXPECT_EQ(clutch.T_wh().position, map.to_world(T_dh).position);
    EXPECT_EQ(clutch.T_wh().rotation, map.to_world(T_dh).rotation);
    const wrench w{d.inside(9.0), d.inside(1.0)};
    const vec3 point_w = d.inside(1.0);
    EXPECT_EQ(clutch.to_device(w, point_w).torque, map.to_device(w, point_w, map.to_world(T_dh).position).torque);
    EXPECT_EQ(clutch.ratio(), 1.0);
  }
}

/// A hand that works in a world of this scale and uses the clutch at drawn times.
plane_case clutched(double scale, std::int64_t device_ns, int kind, drawn& d) {
  plane_case c;
  c.body = block_on_plate(kind == 0 ? 0.001 : 0.02);
  c.body.reported_gap_m = std::max(1.0, scale) * reach_for(1e-3, 1e-9 * static_cast<double>(device_ns));
  c.control.guard.enabled = false;
  c.control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(device_ns), scale);
  c.control.probe = felt_alike({}, scale);
  c.schedule = {.device_period_ns = device_ns, .contact_period_ns = one_ms, .contact_one_period_late = true};
  draw_hand(c.hand, kind, d);
  // The world's origin is where the hand comes down; there the block's handle is 10 mm high whatever the scale.
  // Where it begins the block is tilted, and nothing touches.
  const double high_m = (c.hand.motion.T_dh.position.z - 0.01) / std::min(1.0, scale);
  c.hand.motion.depth_m += high_m - (c.hand.motion.T_dh.position.z - 0.01);
  if (kind == 2) c.hand.motion.amplitude_m += high_m - (c.hand.motion.T_dh.position.z - 0.01);
  c.hand.motion.T_dh.position.z = high_m;
  c.control.map.scale = scale;
  c.control.map.T_wd.position = {0, 0, 0.01};
  c.control.clutch.buttons = 2;
  c.length_s = 1.6;
  for (double t = d.between(0.05, 0.4); t < c.length_s; t += d.between(0.2, 0.5)) {
    const double until = t + d.between(0.02, 0.4);
    c.hand.presses.push_back({.buttons = 2U, .from_ns = std::llround(1e9 * t), .until_ns = std::llround(1e9 * until)});
    t = until;
  }
  return c;
}

TEST(clutch_session, makes_no_energy_and_no_step_at_any_scale) {
  drawn d(seed_of(fresh_seed("clutch_session", "36 sessions, 360 at length"), "hands"));
  std::printf("| scale | rate | most energy | fastest change | deepest |\n|---|---|---|---|---|\n");
  for (const double scale : {0.2, 1.0, 5.0}) {
    for (const std::int64_t device_ns : {5'000'000, 1'000'000, 250'000, 100'000}) {
      double surplus_j = 0.0, step = 0.0, deepest_m = 0.0;
      for (int i = 0; i < extent(1, 10) * hand_kinds; ++i) {
        plane_case c = clutched(scale, device_ns, i % hand_kinds, d);
        c.control.velocity = static_cast<velocity_source>(i % 3);
        const plane_outcome o = run(c);
        EXPECT_EQ(o.not_ok, 0U);
        EXPECT_LE(o.surplus_j, 1e-5) << scale << ' ' << device_ns << " hand " << i % hand_kinds;
        EXPECT_LT(o.deepest_m, 4e-4) << scale << ' ' << device_ns << " hand " << i % hand_kinds;
        surplus_j = std::max(surplus_j, o.surplus_j);
        step = std::max(step, o.step_n_per_ms);
        deepest_m = std::max(deepest_m, o.deepest_m);
      }
      std::printf("| %.1f | %.0f Hz | %.1f uJ | %.3f N/ms | %.3f mm |\n", scale, 1e9 / static_cast<double>(device_ns),
                  1e6 * surplus_j, step, 1e3 * deepest_m);
    }
  }
}

struct clutch_log {
  std::vector<session_record>* to;
  void operator()(const session_record& r) noexcept { to->push_back(r); }
};

using session_of_clutch = virtual_session<plane_body, simulated_device, clutch_log>;

double fastest_change_n_per_ms(const std::vector<session_record>& log, double from_s, double until_s) {
  double out = 0.0;
  for (std::size_t i = 1; i < log.size(); ++i) {
    const double t = 1e-9 * static_cast<double>(log[i].time_ns);
    if (t < from_s || t > until_s) continue;
    out = std::max(out, glm::length(log[i].on_hand_d.force - log[i - 1].on_hand_d.force));
  }
  return out;
}

// Let go under the full press of the device, 10 N, and taken up again: the force goes and comes over the ramp, what was
// pressed is lost while nothing is felt, and the probe stays.
TEST(clutch_session, under_a_press_is_felt_as_a_ramp) {
  for (const double scale : {0.2, 1.0, 5.0}) {
    simulated_settings hand = hand_that_presses(10.0, {0, 0, 0.0}, {0, 0, -1}, 1500.0);
    hand.presses = {{.buttons = 4U, .from_ns = 800 * one_ms, .until_ns = 1400 * one_ms}};
    control_settings control;
    control.coupling = coupling_for(simulated_capabilities(), 1000.0, scale);
    control.probe = felt_alike({}, scale);
    control.map.scale = scale;
    control.map.T_wd.position = {0, 0, 0.01};
    control.clutch.buttons = 4;
    std::vector<session_record> log;
    simulated_device dev(hand);
    ASSERT_TRUE(dev.open() && dev.arm());
    session_of_clutch session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
    static_cast<void>(session.run_until(2200 * one_ms));
    const double pressed_n = glm::length(log[790].on_hand_d.force);
    EXPECT_NEAR(pressed_n, 10.0, 1.0);
    EXPECT_LT(fastest_change_n_per_ms(log, 0.79, 2.2), 0.15) << scale;  // 10 N in 150 ms are 0.067
    std::printf("  scale %.1f: %.3f N/ms at most\n", scale, fastest_change_n_per_ms(log, 0.79, 2.2));
    EXPECT_EQ(glm::length(log[960].on_hand_d.force), 0.0);
    EXPECT_EQ(log[960].clutch_ratio, 0.0);
    EXPECT_EQ(log[960].buttons, 4U);
    EXPECT_LT(glm::length(log[1390].T_wa.position - log[1390].T_wa_target.position), 2e-4);
    EXPECT_LT(glm::length(log[2199].on_hand_d.force), 0.7 * pressed_n);  // the way that it had pressed is gone
    // The probe is not thrown by what the coupling loses: it stays where it was pressed, by the planes' own springs.
    for (std::size_t i = 940; i < 1390; ++i) {
      ASSERT_LT(glm::length(log[i].T_wa.position - log[940].T_wa.position), 1.5e-4) << i << ' ' << scale;
    }
    EXPECT_LE(session.device().guard().surplus_j(), 1e-5);
    EXPECT_EQ(session.device().gate().fault(), gate_fault::none);
  }
}

TEST(clutch_session, obeys_the_application_where_it_may) {
  for (const bool may : {false, true}) {
    control_settings control;
    control.clutch = {.buttons = 1, .by_application = may};
    std::vector<session_record> log;
    simulated_settings hand;
    hand.motion.kind = motion_kind::free;
    hand.motion.T_dh.position.z = 0.5;
    simulated_device dev(hand);
    ASSERT_TRUE(dev.open() && dev.arm());
    session_of_clutch session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
    static_cast<void>(session.run_until(1000 * one_ms));
    session.let_go(true);
    static_cast<void>(session.run_until(1200 * one_ms));
    EXPECT_EQ(log.back().clutch_ratio, may ? 0.0 : 1.0);
    session.let_go(false);
    static_cast<void>(session.run_until(1400 * one_ms));
    EXPECT_EQ(log.back().clutch_ratio, 1.0);
    EXPECT_EQ(log.back().buttons_told, false);
  }
}

// A fault while the handle has let go: the probe waits where it is, not where the hand happens to be afterwards.
TEST(clutch_session, keeps_its_place_over_a_fault) {
  simulated_settings hand;
  hand.motion.kind = motion_kind::free;
  hand.motion.amplitude_m = 0.05;
  hand.motion.T_dh.position.z = 0.5;
  hand.presses = {{.buttons = 1U, .from_ns = 800 * one_ms, .until_ns = 1600 * one_ms}};
  hand.faults = {{device_fault::nan_pose, 1000 * one_ms, 1020 * one_ms}};
  control_settings control;
  control.clutch.buttons = 1;
  std::vector<session_record> log;
  simulated_device dev(hand);
  ASSERT_TRUE(dev.open() && dev.arm());
  session_of_clutch session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
  static_cast<void>(session.run_until(1100 * one_ms));
  EXPECT_EQ(session.device().gate().fault(), gate_fault::bad_samples);
  const vec3 rested = log[990].T_wa.position;
  static_cast<void>(session.run_until(1500 * one_ms));
  ASSERT_TRUE(session.device().clear_fault());
  static_cast<void>(session.step());
  EXPECT_LT(glm::length(log.back().T_wa.position - rested), 1e-6);
  for (const session_record& r : log) {
    ASSERT_TRUE(is_finite(r.T_wa.position));
    ASSERT_TRUE(is_finite(r.on_hand_d.force));
  }
}

TEST(clutch_session, of_a_ramp_that_cannot_be_takes_the_shortest) {
  for (const double ramp_s : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    clutched_map clutch({}, {.buttons = 1, .ramp_s = ramp_s});
    static_cast<void>(clutch.follow({}, false, 0.0));
    clutch.take_up({});
    static_cast<void>(clutch.follow({}, true, 1e-3));
    EXPECT_NEAR(clutch.ratio(), 0.95, 1e-12);
  }
}

TEST(scale, is_felt_alike) {
  const probe_settings p = felt_alike({}, 5.0);
  EXPECT_DOUBLE_EQ(p.mass_kg, probe_settings{}.mass_kg / 25.0);
  EXPECT_EQ(p.inertia_kg_m2, probe_settings{}.inertia_kg_m2);
  const coupling_settings c = coupling_for(simulated_capabilities(), 1000.0, 5.0);
  EXPECT_DOUBLE_EQ(c.max_damping_n_s_per_m, coupling_settings{}.max_damping_n_s_per_m / 25.0);
  // Critical damping in the world is the device's, and so within the bound of the device.
  const virtual_coupling here(c, p.mass_kg, 1e-5);
  const virtual_coupling one(coupling_for(simulated_capabilities(), 1000.0), 0.01, 1e-5);
  EXPECT_NEAR(25.0 * here.damping_n_s_per_m(), one.damping_n_s_per_m(), 1e-9);
  EXPECT_NEAR(25.0 * here.stiffness_n_per_m(), one.stiffness_n_per_m(), 1e-9);
  EXPECT_DOUBLE_EQ(selection_for(1'000'000, 5.0).slide_m, 5.0 * selection_for(1'000'000).slide_m);
  EXPECT_DOUBLE_EQ(selection_for(1'000'000, 0.2).slide_m, selection_for(1'000'000).slide_m);
  control_settings large;
  large.map.scale = 5.0;
  EXPECT_DOUBLE_EQ(with_periods(large, {}).least_gaps_m, 2.5e-3);
}

}  // namespace
