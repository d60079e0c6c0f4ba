// What a first touch rings with: its form, when it comes, and that its work stays within its budget.
#include <algorithm>
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

constexpr transient_settings metal{.amplitude_n_s_per_m = 10.0, .frequency_hz = 150.0, .decay_s = 0.015};

/// Comes down at this speed through free space, and touches.
vec3 touch_at(contact_transient& t, double speed, double dt_s) {
  for (int i = 0; i < static_cast<int>(0.1 / dt_s); ++i) {
    EXPECT_EQ(t.play(vec3(0.0), {0, 0, -speed}, dt_s), vec3(0.0));
  }
  return t.play({0, 0, 0.5}, vec3(0.0), dt_s);
}

TEST(contact_transient, is_a_decaying_sinusoid_against_the_approach) {
  for (const double rate_hz : {750.0, 1000.0, 4000.0, 10'000.0}) {
    contact_transient t(metal, 1.0);
    const double dt = 1.0 / rate_hz;
    vec3 f = touch_at(t, 0.1, dt);
    EXPECT_EQ(t.touches(), 1U);
    double largest = 0.0;
    for (int i = 1; i < static_cast<int>(0.074 * rate_hz); ++i) {
      const double s = i * dt;
      EXPECT_NEAR(f.z, std::exp(-s / 0.015) * std::sin(6.283185307179586 * 150.0 * s), 1e-9) << rate_hz << ' ' << i;
      EXPECT_EQ(f.x, 0.0);
      largest = std::max(largest, f.z);
      f = t.play({0, 0, 0.5}, vec3(0.0), dt);
    }
    EXPECT_GT(largest, 0.6);
    for (int i = 0; i < static_cast<int>(0.01 * rate_hz); ++i) f = t.play({0, 0, 0.5}, vec3(0.0), dt);
    EXPECT_EQ(f, vec3(0.0));
    EXPECT_EQ(t.touches(), 1U);
  }
}

TEST(contact_transient, is_not_faster_than_the_loop_can_tell) {
  contact_transient t({.amplitude_n_s_per_m = 10.0, .frequency_hz = 400.0, .decay_s = 0.1}, 1.0);
  vec3 f = touch_at(t, 0.1, 5e-3);  // 200 Hz: a fifth of it is 40 Hz
  for (int i = 1; i < 20; ++i) {
    EXPECT_NEAR(f.z, std::exp(-i * 0.05) * std::sin(6.283185307179586 * 0.2 * i), 1e-9);
    f = t.play({0, 0, 0.5}, vec3(0.0), 5e-3);
  }
}

double largest_of(double speed, const transient_settings& settings) {
  contact_transient t(settings, 1.0);
  double largest = touch_at(t, speed, 1e-3).z;
  for (int i = 0; i < 100; ++i) largest = std::max(largest, t.play({0, 0, 1}, vec3(0.0), 1e-3).z);
  return largest;
}

TEST(contact_transient, grows_with_the_speed_of_approach_up_to_its_most) {
  const double of_5cm = largest_of(0.05, metal);
  EXPECT_NEAR(largest_of(0.15, metal), 3.0 * of_5cm, 1e-12);
  EXPECT_EQ(largest_of(0.005, metal), 0.0);
  EXPECT_EQ(largest_of(-0.1, metal), 0.0);
  EXPECT_NEAR(largest_of(5.0, metal), 2.0 / 0.5 * of_5cm, 1e-9);
}

TEST(contact_transient, comes_after_a_pause_only) {
  contact_transient t(metal, 1.0);
  // At the start nothing is a first touch before the pause.
  EXPECT_EQ(t.play({0, 0, 1}, {0, 0, -0.1}, 1e-3), vec3(0.0));
  static_cast<void>(touch_at(t, 0.1, 1e-3));
  EXPECT_EQ(t.touches(), 1U);
  for (int bounce = 0; bounce < 10; ++bounce) {
    for (int i = 0; i < 30; ++i) static_cast<void>(t.play(vec3(0.0), {0, 0, -0.1}, 1e-3));
    static_cast<void>(t.play({0, 0, 1}, vec3(0.0), 1e-3));
  }
  EXPECT_EQ(t.touches(), 1U);
  static_cast<void>(touch_at(t, 0.1, 1e-3));
  EXPECT_EQ(t.touches(), 2U);
  t.reset();
  EXPECT_EQ(t.play({0, 0, 1}, {0, 0, -0.1}, 1e-3), vec3(0.0));
  EXPECT_EQ(t.touches(), 2U);
}

// A hand that goes along with every push, as fast as it came.
TEST(contact_transient, gives_no_more_than_its_budget) {
  drawn d(seed_of(fresh_seed("contact_transient", "300 touches"), "budget"));
  for (int i = 0; i < 300; ++i) {
    transient_settings s{.amplitude_n_s_per_m = d.log_between(1.0, 100.0),
                         .frequency_hz = d.between(20.0, 500.0),
                         .decay_s = d.between(0.005, 0.2),
                         .most_force_n = d.between(0.5, 10.0)};
    const double mass_kg = d.log_between(0.02, 0.5), speed = d.between(0.02, 0.5);
    const double dt = 1.0 / d.log_between(200.0, 10'000.0);
    contact_transient t(s, mass_kg);
    vec3 at(0.0);
    vec3 f = touch_at(t, speed, dt);
    t.observe(at);
    double most_j = 0.0;
    for (int k = 0; k < static_cast<int>(1.1 / dt); ++k) {
      at.z += std::copysign(speed * dt * d.between(0.8, 1.0), f.z);
      t.observe(at);
      most_j = std::max(most_j, t.given_j());
      f = t.play({0, 0, 1}, vec3(0.0), dt);
    }
    EXPECT_LE(most_j, 0.25 * mass_kg * speed * speed * (1.0 + 1e-12));
    EXPECT_GT(most_j, 0.0);
    EXPECT_EQ(f, vec3(0.0));
  }
}

struct transient_log {
  std::vector<session_record>* to;
  void operator()(const session_record& r) noexcept { to->push_back(r); }
};
using session_of_transient = virtual_session<plane_body, simulated_device, transient_log>;

/// Root mean square of the force between 100 and 250 Hz in the 30 ms after the first touch, by one wave of 150 Hz.
double ringing_n(const std::vector<session_record>& log) {
  std::size_t touch = 0;
  while (touch < log.size() && glm::length(log[touch].on_probe_w.force) < 1e-3) ++touch;
  double c = 0.0, s = 0.0;
  for (std::size_t i = touch; i < touch + 20 && i < log.size(); ++i) {
    const double a = 6.283185307179586 * 150.0 * 1e-3 * static_cast<double>(i - touch);
    const double slope = log[i].on_hand_d.force.z - log[i - 1].on_hand_d.force.z;
    c += slope * std::cos(a);
    s += slope * std::sin(a);
  }
  return std::sqrt(c * c + s * s);
}

TEST(contact_transient, is_felt_at_a_tap_and_nowhere_else) {
  const auto tap = [](const transient_settings& t, std::vector<session_record>& log) {
    simulated_settings hand;
    hand.motion.kind = motion_kind::tap;
    hand.motion.T_dh.position.z = 0.014;
    hand.motion.depth_m = 0.007;
    hand.motion.amplitude_m = 0.01;
    hand.motion.frequency_hz = 4.0;
    control_settings control;
    control.coupling = coupling_for(simulated_capabilities(), 1000.0);
    control.transient = t;
    simulated_device dev(hand);
    EXPECT_TRUE(dev.open() && dev.arm());
    session_of_transient session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
    static_cast<void>(session.run_until(3'000'000'000));
    EXPECT_EQ(session.device().gate().fault(), gate_fault::none);
    EXPECT_LE(session.device().guard().surplus_j(), 1e-5);
  };
  std::vector<session_record> without, with;
  tap({}, without);
  tap(metal, with);
  EXPECT_EQ(without.back().first_touches, 0U);
  EXPECT_EQ(without.back().transient_j, 0.0);
  EXPECT_GE(with.back().first_touches, 6U);
  EXPECT_LE(with.back().first_touches, 14U);
  EXPECT_GT(ringing_n(with), 2.0 * ringing_n(without));
  std::printf("  ringing %.3f N, without %.3f N; %u first touches, %.3f mJ in all\n", ringing_n(with),
              ringing_n(without), with.back().first_touches, 1e3 * with.back().transient_j);
  // To the first touch both are the same, to the bit.
  std::size_t i = 0;
  while (with[i].first_touches == 0) {
    ASSERT_EQ(with[i].on_hand_d.force, without[i].on_hand_d.force);
    ++i;
  }
}

TEST(contact_transient_session, makes_little_energy_and_no_fault) {
  drawn d(seed_of(fresh_seed("contact_transient_session", "24 sessions, 240 at length"), "hands"));
  for (const bool guard : {false, true}) {
    for (const std::int64_t device_ns : {5'000'000, 1'000'000, 250'000, 100'000}) {
      double surplus_j = 0.0, deepest_m = 0.0, step = 0.0;
      for (int i = 0; i < extent(1, 10) * hand_kinds; ++i) {
        plane_case c;
        c.body = block_on_plate(i % 2 == 0 ? 0.001 : 0.02);
        c.body.reported_gap_m = reach_for(1e-3, 1e-9 * static_cast<double>(device_ns));
        c.control.guard.enabled = guard;
        c.control.transient = {.amplitude_n_s_per_m = d.between(5.0, 30.0),
                               .frequency_hz = d.between(60.0, 300.0),
                               .decay_s = d.between(0.005, 0.05)};
        c.control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(device_ns));
        c.schedule = {.device_period_ns = device_ns, .contact_period_ns = 1'000'000, .contact_one_period_late = true};
        c.length_s = 0.9;
        draw_hand(c.hand, i % hand_kinds, d);
        const plane_outcome o = run(c);
        EXPECT_EQ(o.not_ok, 0U);
        EXPECT_LE(o.surplus_j, 2e-4) << guard << ' ' << device_ns << " hand " << i % hand_kinds;
        EXPECT_LT(o.deepest_m, 4e-4) << guard << ' ' << device_ns << " hand " << i % hand_kinds;
        surplus_j = std::max(surplus_j, o.surplus_j);
        deepest_m = std::max(deepest_m, o.deepest_m);
        step = std::max(step, o.step_n_per_ms);
      }
      std::printf("| %s | %.0f Hz | %.1f uJ | %.3f mm | %.2f N/ms |\n", guard ? "guard" : "no guard",
                  1e9 / static_cast<double>(device_ns), 1e6 * surplus_j, 1e3 * deepest_m, step);
    }
  }
}

TEST(contact_transient, that_cannot_be_is_refused_and_not_played) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<transient_settings> wrong{{.amplitude_n_s_per_m = -1.0},
                                              {.amplitude_n_s_per_m = nan},
                                              {.amplitude_n_s_per_m = 1e3},
                                              {.amplitude_n_s_per_m = 1.0, .frequency_hz = 5.0},
                                              {.amplitude_n_s_per_m = 1.0, .frequency_hz = nan},
                                              {.amplitude_n_s_per_m = 1.0, .decay_s = 0.0},
                                              {.amplitude_n_s_per_m = 1.0, .decay_s = 1.0},
                                              {.amplitude_n_s_per_m = 1.0, .most_force_n = 50.0},
                                              {.amplitude_n_s_per_m = 1.0, .quiet_s = 0.0}};
  for (const transient_settings& t : wrong) {
    EXPECT_FALSE(check(t));
    EXPECT_FALSE(contact_transient(t).used());
  }
  EXPECT_TRUE(check(metal));
  EXPECT_TRUE(check(transient_settings{}));
  EXPECT_FALSE(contact_transient({}).used());
  EXPECT_EQ(contact_transient({}).play({0, 0, 1}, {0, 0, -1}, 1e-3), vec3(0.0));
}

TEST(contact_transient, ends_with_a_fault_and_is_not_felt_by_a_hand_that_has_let_go) {
  contact_transient t(metal, 1.0);
  static_cast<void>(touch_at(t, 0.1, 1e-3));
  EXPECT_EQ(t.play({0, 0, 1}, vec3(0.0), 1e-3, 0.0), vec3(0.0));
  EXPECT_NE(t.play({0, 0, 1}, vec3(0.0), 1e-3, 0.5), vec3(0.0));
  t.reset();
  EXPECT_EQ(t.play({0, 0, 1}, vec3(0.0), 1e-3), vec3(0.0));
  EXPECT_EQ(t.play({0, 0, 1}, {0, 0, std::numeric_limits<double>::quiet_NaN()}, 0.0), vec3(0.0));
}

}  // namespace
