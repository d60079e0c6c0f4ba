// The handle's weight, held up by the motors: it does not sag, its work is its own, and no limit is passed for it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr std::int64_t tick_ns = 1'000'000;
constexpr double gravity = 9.81;

struct weight_log {
  std::vector<session_record>* to;
  void operator()(const session_record& r) noexcept { to->push_back(r); }
};
using session_of_weight = virtual_session<plane_body, simulated_device, weight_log>;

/// A hand that holds a handle of 150 g, whose centre of mass is 30 mm in front of it, high above everything.
simulated_settings holding_hand() {
  simulated_settings c;
  c.hand = soft_hand();
  c.plant.gravity_d = {0, 0, -gravity};
  c.plant.centre_h = {0.03, 0, 0};
  c.motion.kind = motion_kind::press;
  c.motion.T_dh.position.z = 0.5;
  c.motion.depth_m = 0.0;
  return c;
}

weight_settings weight_of(const simulated_settings& c) {
  return {.mass_kg = c.plant.mass_kg, .centre_h = c.plant.centre_h, .gravity_d = c.plant.gravity_d};
}

TEST(handle_weight, does_not_sag) {
  for (const bool held : {false, true}) {
    const simulated_settings hand = holding_hand();
    control_settings control;
    if (held) control.weight = weight_of(hand);
    std::vector<session_record> log;
    simulated_device dev(hand);
    ASSERT_TRUE(dev.open() && dev.arm());
    session_of_weight session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
    static_cast<void>(session.run_until(2000 * tick_ns));
    const double sag_m = 0.5 - dev.true_T_dh().position.z;
    const double sag_rad = glm::length(log_rotation(dev.true_T_dh().rotation));
    if (held) {
      EXPECT_LT(std::fabs(sag_m), 2e-4);
      EXPECT_LT(sag_rad, 1e-3);
      EXPECT_EQ(log.back().weight_share, 1.0);
      EXPECT_NEAR(log.back().on_hand_d.force.z, 0.15 * gravity, 0.02);
      EXPECT_NEAR(log.back().on_hand_d.torque.y, -0.03 * 0.15 * gravity, 1e-3);
      // It comes over half a second, not at once.
      double fastest = 0.0;
      for (std::size_t i = 1; i < log.size(); ++i) {
        fastest = std::max(fastest, glm::length(log[i].on_hand_d.force - log[i - 1].on_hand_d.force));
      }
      EXPECT_LT(fastest, 0.04);
      EXPECT_NEAR(log[250].weight_share, 0.5, 0.01);
    } else {
      EXPECT_NEAR(sag_m, 0.15 * gravity / hand.hand.stiffness_n_per_m, 5e-4);
      EXPECT_GT(sag_rad, 0.05);
    }
  }
}

struct lifted {
  double delivered_j = 0.0, surplus_j = 0.0, raised_j = 0.0;
  std::uint64_t guarded = 0;
  gate_fault fault = gate_fault::none;
};

/// A firm hand that goes up and down by up to 0.15 m, turning, for 6 s; on a face or in free space.
lifted lift(bool held, bool presses, drawn& d) {
  simulated_settings hand = holding_hand();
  hand.hand = firm_hand();
  hand.seed = d.bits();
  hand.motion.kind = presses ? motion_kind::tap : motion_kind::free;
  hand.motion.amplitude_m = 0.15;
  hand.motion.depth_m = presses ? 0.01 : 0.0;
  hand.motion.T_dh.position.z = presses ? 0.014 : 0.5;
  hand.motion.frequency_hz = d.between(0.3, 0.6);
  hand.plant.mass_kg = 0.35;
  control_settings control;
  control.coupling = coupling_for(simulated_capabilities(), 1000.0);
  if (held) control.weight = weight_of(hand);
  std::vector<session_record> log;
  simulated_device dev(hand);
  EXPECT_TRUE(dev.open() && dev.arm());
  session_of_weight session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
  static_cast<void>(session.run_until(6000 * tick_ns));
  lifted out;
  double least = 0.0;
  for (const session_record& r : log) {
    least = std::min(least, r.delivered_j);
    out.delivered_j = std::max(out.delivered_j, r.delivered_j - least);
    out.surplus_j = std::max(out.surplus_j, r.surplus_j);
    out.raised_j = std::max(out.raised_j, std::fabs(r.raised_j));
    if (r.guard_scale < 1.0) ++out.guarded;
  }
  out.fault = log.back().fault;
  const plant_energy& e = dev.energy();
  EXPECT_NEAR(e.by_device_j + e.by_hand_j + e.by_weight_j - e.damped_j - e.numerical_j, dev.kinetic_j(), 1e-9);
  return out;
}

// The motors give the hand half a joule on its way up, which would shut the gate five times over: the guard has to know
// that it is the weight's.
TEST(handle_weight, is_not_taken_for_the_loops_energy) {
  drawn d(seed_of(fresh_seed("handle_weight", "6 sessions, 60 at length"), "lift"));
  for (int i = 0; i < extent(3, 30); ++i) {
    for (const bool presses : {false, true}) {
      const lifted o = lift(true, presses, d);
      EXPECT_EQ(o.fault, gate_fault::none);
      EXPECT_GT(o.delivered_j, 0.2) << presses;
      EXPECT_GT(o.raised_j, 0.2) << presses;
      EXPECT_LT(o.surplus_j, 1e-3) << presses;
      EXPECT_EQ(o.guarded, 0U) << presses;
      std::printf("  %s: %.0f mJ given, of the weight %.0f mJ, surplus %.3f mJ\n", presses ? "taps" : "wanders",
                  1e3 * o.delivered_j, 1e3 * o.raised_j, 1e3 * o.surplus_j);
    }
  }
}

// The account lends what the weight gained in height and no more, whatever wrench is said to have been held.
TEST(handle_weight, lends_no_more_than_its_height) {
  drawn d(seed_of(fresh_seed("handle_weight_account", "100 walks of 500 ticks"), "account"));
  for (int i = 0; i < 100; ++i) {
    const weight_settings w{.mass_kg = d.between(0.05, 0.4), .centre_h = d.inside(0.05)};
    handle_weight weight(w, simulated_capabilities());
    ASSERT_TRUE(weight.held());
    pose T{exp_rotation(d.inside(1.0)), d.inside(0.1)};
    const auto height_j = [&] { return w.mass_kg * gravity * (T * w.centre_h).z; };
    double lent_j = 0.0, low_j = height_j(), high_j = height_j();
    wrench wanted;
    for (int k = 0; k < 500; ++k) {
      // Everything, nothing, a part, or something else than was wanted.
      const wrench held = d.between(0.0, 3.0) * wanted + wrench{d.inside(1.0), d.inside(0.1)};
      lent_j += weight.observe(T, d.between(0.0, 1.0) < 0.5 ? held : wanted, wanted);
      low_j = std::min(low_j, height_j());
      high_j = std::max(high_j, height_j());
      EXPECT_LE(lent_j, height_j() - low_j + 1e-12);
      EXPECT_GE(lent_j, height_j() - high_j - 1e-12);
      wanted = weight.hold(T, true, 1e-2) + wrench{d.inside(2.0), {}};
      T = {glm::normalize(exp_rotation(d.inside(0.02)) * T.rotation), T.position + d.inside(2e-3)};
    }
  }
}

TEST(handle_weight, lends_the_part_that_left_the_gate) {
  for (const double part : {0.0, 0.5, 1.0}) {
    handle_weight weight({.mass_kg = 0.2}, simulated_capabilities());
    pose T;
    for (int k = 0; k < 60; ++k) static_cast<void>(weight.hold(T, true, 1e-2));
    const wrench wanted = weight.hold(T, true, 1e-3);
    EXPECT_EQ(weight.observe(T, wanted, wanted), 0.0);
    T.position.z += 0.01;
    EXPECT_NEAR(weight.observe(T, part * wanted, wanted), part * 0.2 * gravity * 0.01, 1e-12);
  }
}

TEST(handle_weight, that_came_out_whole_is_its_height) {
  handle_weight weight({.mass_kg = 0.2, .centre_h = {0.02, 0.01, 0.05}}, simulated_capabilities());
  drawn d(7);
  pose T{exp_rotation({0.3, 0.2, 0.1}), {0, 0, 0.1}};
  for (int k = 0; k < 60; ++k) static_cast<void>(weight.hold(T, true, 1e-2));
  EXPECT_EQ(weight.share(), 1.0);
  wrench wanted = weight.hold(T, true, 1e-3);
  EXPECT_EQ(weight.observe(T, wanted, wanted), 0.0);
  double lent_j = 0.0;
  const double before_j = 0.2 * gravity * (T * vec3(0.02, 0.01, 0.05)).z;
  for (int k = 0; k < 2000; ++k) {
    T = {glm::normalize(exp_rotation(vec3(5e-4, -2e-4, 0.0)) * T.rotation), T.position + vec3(0, 1e-5, 5e-5)};
    lent_j += weight.observe(T, wanted, wanted);
    wanted = weight.hold(T, true, 1e-3);
  }
  EXPECT_NEAR(lent_j, 0.2 * gravity * (T * vec3(0.02, 0.01, 0.05)).z - before_j, 1e-4);
}

TEST(handle_weight, goes_with_every_fault_and_comes_back_slowly) {
  simulated_settings hand = holding_hand();
  hand.faults = {{device_fault::nan_pose, 1000 * tick_ns, 1030 * tick_ns}};
  control_settings control;
  control.weight = weight_of(hand);
  std::vector<session_record> log;
  simulated_device dev(hand);
  ASSERT_TRUE(dev.open() && dev.arm());
  session_of_weight session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
  static_cast<void>(session.run_until(1500 * tick_ns));
  EXPECT_EQ(log.back().fault, gate_fault::bad_samples);
  EXPECT_EQ(log[1020].on_hand_d.force, vec3(0.0));
  EXPECT_EQ(dev.state(), device_state::ready);
  ASSERT_TRUE(session.device().clear_fault());
  static_cast<void>(session.run_until(1700 * tick_ns));
  EXPECT_EQ(log.back().on_hand_d.force, vec3(0.0));  // nobody armed
  EXPECT_EQ(log.back().weight_share, 0.0);
  ASSERT_TRUE(dev.arm());
  static_cast<void>(session.run_until(1800 * tick_ns));
  EXPECT_NEAR(log.back().weight_share, 0.2, 0.01);
  for (const session_record& r : log) ASSERT_TRUE(is_finite(r.on_hand_d.force) && is_finite(r.on_hand_d.torque));
}

TEST(handle_weight, stays_within_every_limit) {
  simulated_settings hand = hand_that_presses(60.0, {0, 0, 0.01}, {0, 0, -1}, 1500.0);
  hand.capabilities = simulated_capabilities();
  hand.plant.gravity_d = {0, 0, -gravity};
  hand.plant.mass_kg = 0.4;
  control_settings control;
  control.coupling = coupling_for(simulated_capabilities(), 1000.0);
  control.weight = weight_of(hand);
  std::vector<session_record> log;
  simulated_device dev(hand);
  ASSERT_TRUE(dev.open() && dev.arm());
  session_of_weight session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control, {}, {&log});
  static_cast<void>(session.run_until(2000 * tick_ns));
  double largest = 0.0;
  for (std::size_t i = 1; i < log.size(); ++i) {
    largest = std::max(largest, glm::length(log[i].on_hand_d.force));
    EXPECT_LT(glm::length(log[i].on_hand_d.force - log[i - 1].on_hand_d.force), 5.0001);
  }
  EXPECT_GT(largest, 19.0);
  EXPECT_LE(largest, 20.0000001);
  EXPECT_LT(session.device().gate().force_mean_square(), 64.0 * 1.01);
}

TEST(handle_weight, of_what_cannot_be_is_refused_and_not_held) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const device_capabilities device = simulated_capabilities();  // 8 N and 0.5 N m for ever
  const std::vector<weight_settings> wrong{{.mass_kg = -0.1},
                                           {.mass_kg = nan},
                                           {.mass_kg = 0.5},  // 4.9 N
                                           {.mass_kg = 0.1, .centre_h = {nan, 0, 0}},
                                           {.mass_kg = 0.1, .centre_h = {0.6, 0, 0}},
                                           {.mass_kg = 0.3, .centre_h = {0.1, 0, 0}},  // 0.29 N m
                                           {.mass_kg = 0.1, .gravity_d = {0, 0, -30}},
                                           {.mass_kg = 0.1, .ramp_s = 0.0}};
  for (const weight_settings& w : wrong) {
    EXPECT_FALSE(check(w, device)) << w.mass_kg;
    EXPECT_FALSE(handle_weight(w, device).held()) << w.mass_kg;
  }
  EXPECT_TRUE(check({}, device));
  EXPECT_FALSE(handle_weight({}, device).held());
  EXPECT_TRUE(check({.mass_kg = 0.4}, device));
  EXPECT_TRUE(handle_weight({.mass_kg = 0.4}, device).held());
  device_capabilities no_torque = device;
  no_torque.continuous_torque_n_m = 0.0;
  EXPECT_TRUE(check({.mass_kg = 0.3, .centre_h = {0.1, 0, 0}}, no_torque));
  EXPECT_FALSE(check({.mass_kg = 0.01}, {}));
}

}  // namespace
