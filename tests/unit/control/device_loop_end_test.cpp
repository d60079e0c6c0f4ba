// What ends the output of a device loop, or takes a tick out of it: samples, devices, applications, energy, renderers.
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "unit/control/wall_session.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;
using test_support::force_of;
using test_support::keep_all;
using test_support::ms;
using test_support::pressing_hand;
using test_support::wall_session;

struct fault_case {
  device_fault kind;
  sample_verdict verdict;
};

class bad_sample_test : public testing::TestWithParam<fault_case> {};

// One bad sample: nothing is wanted in that tick, and the session goes on. One repeated sample is an ordinary thing,
// and the force goes on as well. Five in a row: the gate shuts.
TEST_P(bad_sample_test, is_rejected_and_survived_once) {
  simulated_settings hand = pressing_hand();
  hand.faults = {{GetParam().kind, 800 * ms, 801 * ms}};
  wall_session r(hand);
  r.run_ms(1200);
  const bool rejected = GetParam().kind != device_fault::stale;
  EXPECT_EQ(r.log[800].sample, rejected ? GetParam().verdict : sample_verdict::accepted);
  EXPECT_EQ(r.log[801].sample, sample_verdict::accepted);
  EXPECT_TRUE(is_finite(r.log[800].on_hand_d));
  if (rejected) {
    EXPECT_LT(force_of(r.log[800]), force_of(r.log[799]));
  } else {
    EXPECT_NEAR(force_of(r.log[800]), force_of(r.log[799]), 0.1);
  }
  EXPECT_NEAR(force_of(r.last()), force_of(r.log[799]), 0.1);
  EXPECT_EQ(r.last().fault, gate_fault::none);
}

TEST_P(bad_sample_test, shuts_the_gate_when_it_lasts) {
  simulated_settings hand = pressing_hand();
  hand.faults = {{GetParam().kind, 800 * ms, 10'000 * ms}};
  wall_session r(hand);
  r.run_ms(900);
  EXPECT_GT(force_of(r.log[799]), 1.0);
  std::size_t first_fault = 0;
  while (first_fault < r.log.size() && r.log[first_fault].fault == gate_fault::none) ++first_fault;
  ASSERT_LT(first_fault, r.log.size());
  EXPECT_EQ(r.log[first_fault].fault, gate_fault::bad_samples);
  EXPECT_EQ(r.log[first_fault].sample, GetParam().verdict);
  // Rejected samples up to the limit; a repeated one first has to grow old (20 ms).
  EXPECT_LE(first_fault, 800U + 5U + (GetParam().kind == device_fault::stale ? 21U : 0U));
  // Then from 20 N to zero at 5 N per tick.
  for (std::size_t i = first_fault + 4; i < r.log.size(); ++i) EXPECT_EQ(force_of(r.log[i]), 0.0);
  EXPECT_EQ(r.dev.state(), device_state::ready);  // disarmed
  EXPECT_EQ(r.session.device().gate().flight().size(), flight_recorder::capacity());
}

INSTANTIATE_TEST_SUITE_P(every_kind, bad_sample_test,
                         testing::Values(fault_case{device_fault::nan_pose, sample_verdict::not_finite},
                                         fault_case{device_fault::infinite_pose, sample_verdict::not_finite},
                                         fault_case{device_fault::bad_rotation, sample_verdict::not_unit},
                                         fault_case{device_fault::jump, sample_verdict::jump},
                                         fault_case{device_fault::drop, sample_verdict::no_answer},
                                         fault_case{device_fault::stale, sample_verdict::stale}));

TEST(device_loop, never_arms_again_by_itself) {
  simulated_settings hand = pressing_hand();
  hand.faults = {{device_fault::nan_pose, 800 * ms, 850 * ms}};
  wall_session r(hand);
  r.run_ms(1500);
  EXPECT_EQ(r.last().fault, gate_fault::bad_samples);  // the samples have been good for long
  EXPECT_EQ(r.last().sample, sample_verdict::accepted);
  EXPECT_EQ(force_of(r.last()), 0.0);
  ASSERT_TRUE(r.session.device().clear_fault());
  r.run_ms(100);
  EXPECT_EQ(r.last().device, device_state::ready);
  const double before = r.dev.delivered_j();
  r.run_ms(100);
  EXPECT_EQ(r.dev.delivered_j(), before);
  ASSERT_TRUE(r.dev.arm());
  r.run_ms(100);
  EXPECT_EQ(r.last().device, device_state::active);
}

// Encoder steps to and fro turn damping into a source. Where the guard cannot hold the sum, the gate shuts.
TEST(device_loop, shuts_where_the_guard_cannot_hold_the_energy) {
  control_settings control;
  control.guard.soft_limit_j = -1.0;
  control.guard.hard_limit_j = 1.0;  // a guard that is too weak on purpose
  control.guard.cut_off_j = 0.01;
  control.guard.mass_kg = 1e-9;
  control.guard.inertia_kg_m2 = 1e-12;
  analytic_wall wall;
  wall.linearised = false;
  wall.stiffness_n_per_m = 5000.0;
  simulated_device dev(pressing_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  std::vector<session_record> log;
  virtual_session<analytic_wall, simulated_device, keep_all> session(
      wall, {{pose{}}, vec3(0.0)}, dev, control, {.contact_period_ns = 10 * ms, .contact_one_period_late = true},
      keep_all{&log});
  static_cast<void>(session.run_until(5000 * ms));
  const session_record& end = log.back();
  EXPECT_EQ(end.fault, gate_fault::energy);
  EXPECT_EQ(force_of(end), 0.0);
  EXPECT_EQ(end.device, device_state::ready);
  EXPECT_GT(end.surplus_j, control.guard.cut_off_j);
  EXPECT_LT(end.surplus_j, 0.1);
  EXPECT_TRUE(session.device().clear_fault());
  EXPECT_EQ(session.device().guard().surplus_j(), 0.0);
}

TEST(device_loop, shuts_where_the_device_refuses_a_command) {
  simulated_settings hand = pressing_hand();
  hand.faults = {{device_fault::refuse_write, 800 * ms, 801 * ms}};
  wall_session r(hand);
  r.run_ms(900);
  EXPECT_EQ(r.last().fault, gate_fault::device_failed);
  EXPECT_EQ(force_of(r.last()), 0.0);
}

TEST(device_loop, a_device_that_leaves_and_returns_stays_in_its_fault) {
  simulated_settings hand = pressing_hand();
  hand.faults = {{device_fault::depart, 800 * ms, 801 * ms}};
  wall_session r(hand);
  r.run_ms(900);
  EXPECT_EQ(r.dev.state(), device_state::fault);
  EXPECT_EQ(r.last().fault, gate_fault::device_departed);
  r.dev.plug_in();
  r.run_ms(100);
  EXPECT_EQ(r.dev.state(), device_state::fault);
  EXPECT_FALSE(r.dev.arm());
}

TEST(device_loop, goes_to_zero_when_told_to_stop) {
  wall_session r(pressing_hand());
  r.run_ms(1000);
  EXPECT_GT(force_of(r.last()), 1.0);
  r.session.device().stop();
  r.run_ms(5);
  EXPECT_EQ(force_of(r.last()), 0.0);
  EXPECT_EQ(r.last().fault, gate_fault::stopped);
  EXPECT_EQ(r.dev.state(), device_state::ready);
}

TEST(device_loop, a_device_that_is_closed_has_failed_and_not_departed) {
  wall_session r(pressing_hand());
  r.run_ms(800);
  r.dev.close();
  r.run_ms(1);
  EXPECT_EQ(r.last().fault, gate_fault::device_failed);
}

TEST(device_loop, a_silent_application_shuts_the_gate_and_ticks_alone_do_not_feed_its_watchdog) {
  control_settings control;
  control.watchdog_ns = 50 * ms;
  wall_session r(pressing_hand(), control);
  for (int i = 0; i < 1000; ++i) {
    if (i % 50 == 0) r.session.beat();
    r.run_ms(1);
    ASSERT_EQ(r.last().fault, gate_fault::none) << i;
  }
  EXPECT_GT(force_of(r.last()), 1.0);
  r.session.beat();
  r.run_ms(51);
  EXPECT_EQ(r.last().fault, gate_fault::none);
  r.run_ms(1);
  EXPECT_EQ(r.last().fault, gate_fault::watchdog);
  EXPECT_EQ(r.session.device().gate().fault_time_ns(), 1051 * ms);
  r.session.beat();  // too late: the fault is latched
  r.run_ms(static_cast<int>(time_to_zero_ns(r.session.device().gate().limits(), ms) / ms));
  EXPECT_EQ(force_of(r.last()), 0.0);
  EXPECT_EQ(r.last().fault, gate_fault::watchdog);
  EXPECT_EQ(r.dev.state(), device_state::ready);
  EXPECT_TRUE(r.session.device().clear_fault());
  EXPECT_EQ(r.dev.state(), device_state::ready);
  r.run_ms(50);
  EXPECT_EQ(r.last().fault, gate_fault::none);  // cleared by a person, who counts as a sign of life
  r.run_ms(1);
  EXPECT_EQ(r.last().fault, gate_fault::watchdog);
}

TEST(device_loop, a_loop_that_goes_away_leaves_no_force_behind) {
  simulated_device dev(pressing_hand());
  {
    virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, wall_session::opened(dev), {});
    static_cast<void>(session.run_until(1000 * ms));
    ASSERT_GT(glm::length(session.device().gate().last().force), 1.0);
    ASSERT_EQ(dev.state(), device_state::active);
  }
  EXPECT_EQ(dev.state(), device_state::ready);
  const double delivered_j = dev.delivered_j();
  device_sample in;
  ASSERT_EQ(dev.read(1010 * ms, in), status::ok);  // within the last command's time of validity
  EXPECT_EQ(dev.delivered_j(), delivered_j);
}

// A device that may not put out is told zero at once, so that one that is armed again in the next tick begins at zero.
TEST(device_loop, forgets_its_wrench_with_the_first_tick_of_a_disarmed_device) {
  control_settings control;
  control.limits.force_slew_n_per_s = 200.0;
  wall_session r(pressing_hand(), control);
  r.run_ms(1000);
  ASSERT_GT(force_of(r.last()), 1.0);
  ASSERT_EQ(r.dev.disarm(), status::ok);
  r.run_ms(1);
  EXPECT_EQ(force_of(r.last()), 0.0);
  const double booked_j = r.last().delivered_j;
  ASSERT_TRUE(r.dev.arm());
  r.run_ms(1);
  EXPECT_LE(force_of(r.last()), 0.2 * (1.0 + 1e-9));
  EXPECT_EQ(r.last().delivered_j, booked_j);
}

// What is recorded of a tick without a sample is the last good pose.
TEST(device_loop, a_rejected_sample_goes_nowhere) {
  simulated_settings hand = pressing_hand();
  hand.faults = {{device_fault::nan_pose, 800 * ms, 803 * ms}};
  wall_session r(hand);
  r.run_ms(900);
  for (std::size_t i = 800; i < 803; ++i) {
    EXPECT_NE(r.log[i].sample, sample_verdict::accepted);
    EXPECT_EQ(r.log[i].T_dh.position, r.log[799].T_dh.position);
    EXPECT_EQ(r.log[i].T_wa_target.position, r.log[799].T_wa_target.position);
  }
}

// A wall until it is told otherwise, then forces that no probe can bear.
struct breaking_renderer {
  analytic_wall wall;
  const bool* broken = nullptr;
  status step(const scene_pose& at, tick& out) noexcept {
    const status s = wall.step(at, out);
    if (*broken) out.force.on_probe_w.force = {0.0, 0.0, 1e300};
    return s;
  }
};

// The coupling would go on pulling at a probe that stands where it was lost.
TEST(device_loop, a_lost_probe_pulls_at_nothing) {
  bool broken = false;
  simulated_device dev(pressing_hand());
  std::vector<session_record> log;
  virtual_session<breaking_renderer, simulated_device, keep_all> session(
      {{}, &broken}, {{pose{}}, vec3(0.0)}, wall_session::opened(dev), control_settings{}, {}, keep_all{&log});
  static_cast<void>(session.run_until(1000 * ms));
  ASSERT_GT(force_of(log.back()), 1.0);
  broken = true;
  static_cast<void>(session.run_until(1010 * ms));
  for (std::size_t i = 1003; i < log.size(); ++i) {
    ASSERT_EQ(log[i].probe_status, status::not_finite) << i;
    EXPECT_EQ(force_of(log[i]), 0.0) << i;
  }
}

// After a fault the probe stands where the device is, and not where the wall held it.
TEST(device_loop, begins_anew_at_the_device_when_a_fault_is_cleared) {
  wall_session r(pressing_hand());
  r.run_ms(1000);
  r.session.device().stop();
  r.run_ms(100);
  ASSERT_EQ(force_of(r.last()), 0.0);
  const auto stretch_m = [&] { return glm::length(r.last().T_wa_target.position - r.last().T_wa.position); };
  ASSERT_GT(stretch_m(), 0.004);
  ASSERT_TRUE(r.session.device().clear_fault());
  r.run_ms(1);
  EXPECT_LT(stretch_m(), 0.001);
}

// A renderer gone mad: whatever it answers, what leaves is finite and within the limits.
struct mad_renderer {
  int n = 0;
  status step(const scene_pose&, tick& out) noexcept {
    out = {};
    const double values[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300,
                             -1e300, 1e18};
    const double v = values[n++ % 5];
    out.force.on_probe_w.force = {v, -v, v};
    out.force.on_probe_w.torque = {0.0, v, 0.0};
    out.force.stiffness(1, 1) = v;
    return status::ok;
  }
};

TEST(device_loop, survives_a_renderer_gone_mad) {
  simulated_device dev(pressing_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  std::vector<session_record> log;
  virtual_session<mad_renderer, simulated_device, keep_all> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{},
                                                                    {}, keep_all{&log});
  static_cast<void>(session.run_until(500 * ms));
  for (const session_record& r : log) {
    ASSERT_TRUE(is_finite(r.on_hand_d));
    ASSERT_LE(force_of(r), 20.0 * (1 + 1e-8));
    ASSERT_LE(glm::length(r.on_hand_d.torque), 1.0 * (1 + 1e-8));
    ASSERT_TRUE(is_valid(r.T_wa));
  }
}

}  // namespace
