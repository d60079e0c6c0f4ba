#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include <asperity/control/virtual_session.hpp>
#include <asperity/hal/simulated/simulated_device.hpp>

#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

constexpr std::int64_t ms = 1'000'000;

struct keep_all {
  std::vector<session_record>* to;
  void operator()(const session_record& r) noexcept { to->push_back(r); }
};

// A hand that presses onto the wall at z = 0 and reaches it after about 0.2 s.
simulated_config pressing_hand() {
  simulated_config c;
  c.motion = {.T_dh = {quat(1, 0, 0, 0), {0, 0, 0.005}}, .depth_m = 0.015, .approach_s = 0.4};
  return c;
}

struct rig {
  std::vector<session_record> log;
  simulated_device dev;
  virtual_session<analytic_wall, simulated_device, keep_all> session;

  explicit rig(const simulated_config& hand, const control_config& control = {}, const analytic_wall& wall = {})
      : dev(hand), session(wall, {{pose{}}, vec3(0.0)}, opened(dev), control, {}, keep_all{&log}) {}

  static simulated_device& opened(simulated_device& d) {
    EXPECT_TRUE(d.open() && d.arm());
    return d;
  }
  void run_ms(int n) {
    for (int i = 0; i < n; ++i) static_cast<void>(session.step());
  }
  [[nodiscard]] const session_record& last() const { return log.back(); }
};

double force_of(const session_record& r) { return glm::length(r.on_hand_d.force); }

TEST(device_loop, starts_the_probe_at_the_device_without_a_jump) {
  simulated_config hand = pressing_hand();
  hand.motion.T_dh.position = {0.3, -0.2, 0.1};
  hand.motion.T_dh.rotation = exp_rotation({0.3, 0.1, -1.0});
  rig r(hand);
  r.run_ms(20);
  EXPECT_LT(glm::length(r.log[0].T_wa.position - r.log[0].T_wa_target.position), 1e-12);
  EXPECT_EQ(force_of(r.log[0]), 0.0);
  for (const session_record& t : r.log) EXPECT_LT(force_of(t), 0.05);
}

TEST(device_loop, pushes_back_where_hand_coupling_and_wall_balance) {
  rig r(pressing_hand());
  r.run_ms(3000);
  // Three springs in a row: the hand's 300, the coupling's 500 and the wall's 2000 N/m over the 10 mm below the wall.
  const double expected = 0.010 / (1.0 / 300.0 + 1.0 / 500.0 + 1.0 / 2000.0);
  EXPECT_NEAR(r.last().on_hand_d.force.z, expected, 0.05);
  EXPECT_NEAR(r.last().on_probe_w.force.z, expected, 0.05);
  EXPECT_NEAR(r.last().max_depth_m, expected / 2000.0, 2e-5);
  EXPECT_EQ(r.last().fault, gate_fault::none);
  EXPECT_EQ(r.last().device, device_state::active);
}

TEST(device_loop, puts_nothing_out_before_it_is_armed) {
  simulated_device dev(pressing_hand());
  ASSERT_TRUE(dev.open());
  virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_config{});
  static_cast<void>(session.run_until(1000 * ms));
  EXPECT_EQ(dev.state(), device_state::ready);
  EXPECT_EQ(dev.delivered_j(), 0.0);
}

// The handle carries a probe whose centre of mass is off its axis, in a workspace that is turned and scaled: the hand
// feels the wall's force along the device's own axes, and the torque of the lever.
TEST(device_loop, maps_frames_and_levers) {
  simulated_config hand;
  hand.motion = {.T_dh = {quat(1, 0, 0, 0), {0, 0, 0.005}}, .direction_d = {1, 0, 0}, .depth_m = 0.012};
  hand.hand.stiffness_n_m_per_rad = 1e3;  // a grip that does not turn
  control_config control;
  control.map.T_wd = {exp_rotation({0, 0.5 * 3.141592653589793, 0}), {0, 0, 0.008}};  // device +x is world -z
  control.map.scale = 1.0;
  analytic_wall wall;
  wall.centre_of_mass_a = {0.0, 0.02, 0.0};
  simulated_device dev(hand);
  ASSERT_TRUE(dev.open() && dev.arm());
  std::vector<session_record> log;
  virtual_session<analytic_wall, simulated_device, keep_all> session(wall, {{pose{}}, wall.centre_of_mass_a}, dev,
                                                                     control, {}, keep_all{&log});
  static_cast<void>(session.run_until(2500 * ms));
  const wrench& w = log.back().on_hand_d;
  EXPECT_LT(w.force.x, -0.5);
  EXPECT_NEAR(w.force.y, 0.0, 0.02);
  EXPECT_NEAR(w.force.z, 0.0, 0.02);
  // r x F with r = (0, 0.02, 0): the lever stands along y in both frames, as the map turns about y.
  EXPECT_NEAR(w.torque.z, -0.02 * w.force.x, 0.1 * std::fabs(0.02 * w.force.x));
}

TEST(device_loop, substeps_come_closer_to_the_continuous_probe) {
  const auto lag = [](int substeps) {
    simulated_config hand;
    hand.motion = {
        .kind = motion_kind::scrub, .depth_m = 0.0, .approach_s = 0.01, .amplitude_m = 0.0005, .frequency_hz = 40.0};
    hand.hand = {.stiffness_n_per_m = 2e4, .damping_n_s_per_m = 50.0};
    control_config control;
    control.substeps = substeps;
    rig r(hand, control);
    r.run_ms(1000);
    double sum = 0.0;
    for (std::size_t i = 500; i < 1000; ++i) {
      sum += std::pow(r.log[i].T_wa.position.x - r.log[i].T_wa_target.position.x, 2);
    }
    return sum;
  };
  const double fine = lag(128);
  EXPECT_LT(std::fabs(lag(8) - fine), 0.25 * std::fabs(lag(1) - fine));
}

struct fault_case {
  device_fault kind;
  sample_verdict verdict;
};

class bad_sample_test : public testing::TestWithParam<fault_case> {};

// One bad sample: nothing is wanted in that tick, and the session goes on. One repeated sample is an ordinary thing,
// and the force goes on as well. Five in a row: the gate shuts.
TEST_P(bad_sample_test, is_rejected_and_survived_once) {
  simulated_config hand = pressing_hand();
  hand.faults = {{GetParam().kind, 800 * ms, 801 * ms}};
  rig r(hand);
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
  simulated_config hand = pressing_hand();
  hand.faults = {{GetParam().kind, 800 * ms, 10'000 * ms}};
  rig r(hand);
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
  simulated_config hand = pressing_hand();
  hand.faults = {{device_fault::nan_pose, 800 * ms, 850 * ms}};
  rig r(hand);
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

// Armed while the hand already presses: the wrench grows from zero at the slew rate. Found by simulation.
TEST(device_loop, begins_at_zero_when_it_is_armed_in_contact) {
  control_config control;
  control.limits.force_slew_n_per_s = 200.0;
  rig r(pressing_hand(), control);
  r.run_ms(1000);
  EXPECT_GT(force_of(r.last()), 1.0);
  ASSERT_EQ(r.dev.disarm(), status::ok);
  r.run_ms(100);
  EXPECT_EQ(force_of(r.last()), 0.0);
  EXPECT_GT(glm::length(r.last().T_wa_target.position - r.last().T_wa.position), 0.002);  // 1 N in the coupling
  const double booked_j = r.last().delivered_j;
  r.run_ms(10);
  EXPECT_EQ(r.last().delivered_j, booked_j);  // what is not put out is not booked
  ASSERT_TRUE(r.dev.arm());
  double before = 0.0;
  double largest = 0.0;
  for (int i = 0; i < 100; ++i) {
    r.run_ms(1);
    EXPECT_LE(force_of(r.last()), before + 0.2 * (1.0 + 1e-9));
    before = force_of(r.last());
    largest = std::max(largest, before);
  }
  EXPECT_GT(largest, 1.0);
}

// The loop's time goes on from where it was, so contacts age and the slew rate stays what it is. Found by simulation.
TEST(device_loop, goes_on_where_the_clock_steps_back) {
  simulated_device dev(pressing_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  std::vector<session_record> log;
  exchange shared;
  contact_loop<analytic_wall> contact({}, {{pose{}}, vec3(0.0)}, shared);
  device_loop<simulated_device, keep_all> loop(dev, {}, vec3(0.0), shared, keep_all{&log});
  constexpr std::int64_t hour = 3'600'000'000'000;
  for (int i = 0; i < 1300; ++i) {
    if (i < 1000) {  // then the contact thread stalls
      ASSERT_EQ(contact.tick(i * ms), status::ok);
    }
    ASSERT_EQ(loop.tick(i < 1000 ? i * ms : i * ms - hour), status::ok);
  }
  EXPECT_EQ(log[1000].time_ns, log[999].time_ns);
  EXPECT_EQ(log[1001].time_ns, log[1000].time_ns + ms);
  EXPECT_GT(glm::length(log[1040].on_probe_w.force), 1.0);
  EXPECT_EQ(force_of(log[1110]), 0.0);
}

// Encoder steps to and fro turn damping into a source. Where the guard cannot hold the sum, the gate shuts.
TEST(device_loop, shuts_where_the_guard_cannot_hold_the_energy) {
  control_config control;
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
  simulated_config hand = pressing_hand();
  hand.faults = {{device_fault::refuse_write, 800 * ms, 801 * ms}};
  rig r(hand);
  r.run_ms(900);
  EXPECT_EQ(r.last().fault, gate_fault::device_failed);
  EXPECT_EQ(force_of(r.last()), 0.0);
}

TEST(device_loop, a_device_that_leaves_and_returns_stays_in_its_fault) {
  simulated_config hand = pressing_hand();
  hand.faults = {{device_fault::depart, 800 * ms, 801 * ms}};
  rig r(hand);
  r.run_ms(900);
  EXPECT_EQ(r.dev.state(), device_state::fault);
  EXPECT_EQ(r.last().fault, gate_fault::device_departed);
  r.dev.plug_in();
  r.run_ms(100);
  EXPECT_EQ(r.dev.state(), device_state::fault);
  EXPECT_FALSE(r.dev.arm());
}

TEST(device_loop, goes_to_zero_when_told_to_stop) {
  rig r(pressing_hand());
  r.run_ms(1000);
  EXPECT_GT(force_of(r.last()), 1.0);
  r.session.device().stop();
  r.run_ms(5);
  EXPECT_EQ(force_of(r.last()), 0.0);
  EXPECT_EQ(r.last().fault, gate_fault::stopped);
  EXPECT_EQ(r.dev.state(), device_state::ready);
}

TEST(device_loop, a_device_that_is_closed_has_failed_and_not_departed) {
  rig r(pressing_hand());
  r.run_ms(800);
  r.dev.close();
  r.run_ms(1);
  EXPECT_EQ(r.last().fault, gate_fault::device_failed);
}

TEST(device_loop, a_silent_application_shuts_the_gate_and_ticks_alone_do_not_feed_its_watchdog) {
  control_config control;
  control.watchdog_ns = 50 * ms;
  rig r(pressing_hand(), control);
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
    virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, rig::opened(dev), {});
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

// A loop that stands still: the device, which holds the last command, lets go 20 ms after it.
TEST(device_loop, a_loop_that_stands_still_is_forgotten_by_the_device) {
  rig r(pressing_hand());
  r.run_ms(1000);
  ASSERT_GT(force_of(r.last()), 1.0);
  const std::int64_t told_at_ns = r.last().time_ns;
  wrench held;
  ASSERT_EQ(r.dev.applied(told_at_ns + 20 * ms, held), status::ok);
  EXPECT_EQ(held.force, r.last().on_hand_d.force);
  ASSERT_EQ(r.dev.applied(told_at_ns + 20 * ms + 1, held), status::ok);
  EXPECT_TRUE(is_zero(held));
}

// Nothing is felt of it, but it goes on holding the probe: let go, the probe would sink into the body, and the next
// contact would throw it out.
TEST(device_loop, a_contact_that_stays_away_is_no_longer_felt) {
  simulated_device dev(pressing_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  std::vector<session_record> log;
  exchange shared;
  analytic_wall wall;
  contact_loop<analytic_wall> contact(wall, {{pose{}}, vec3(0.0)}, shared);
  device_loop<simulated_device, keep_all> loop(dev, {}, vec3(0.0), shared, keep_all{&log});
  for (int i = 0; i < 1300; ++i) {
    if (i < 1000) {  // then the contact thread stalls
      ASSERT_EQ(contact.tick(i * ms), status::ok);
    }
    ASSERT_EQ(loop.tick(i * ms), status::ok);
  }
  EXPECT_GT(glm::length(log[1040].on_probe_w.force), 1.0);
  EXPECT_EQ(force_of(log[1110]), 0.0);
  EXPECT_EQ(force_of(log.back()), 0.0);
  EXPECT_NEAR(log.back().T_wa.position.z, log[1100].T_wa.position.z, 2e-4);
}

TEST(device_loop, keeps_within_the_limits_of_device_and_application) {
  control_config control;
  control.limits.peak_force_n = 0.7;
  rig r(pressing_hand(), control);
  r.run_ms(1500);
  double largest = 0.0;
  for (const session_record& t : r.log) largest = std::max(largest, force_of(t));
  EXPECT_NEAR(largest, 0.7, 1e-9);
}

// The device's own limits hold although the application states none.
TEST(device_loop, keeps_within_what_the_device_states_of_itself) {
  simulated_config hand = pressing_hand();
  hand.capabilities.peak_force_n = hand.capabilities.continuous_force_n = 0.6;
  hand.capabilities.force_slew_n_per_s = 20.0;
  rig r(hand);
  r.run_ms(1500);
  double largest = 0.0;
  double steepest = 0.0;
  for (std::size_t i = 1; i < r.log.size(); ++i) {
    largest = std::max(largest, force_of(r.log[i]));
    steepest = std::max(steepest, glm::length(r.log[i].on_hand_d.force - r.log[i - 1].on_hand_d.force));
  }
  EXPECT_NEAR(largest, 0.6, 1e-9);
  EXPECT_LE(steepest, 0.020 * (1.0 + 1e-9));
}

// A device that may not put out is told zero at once, so that one that is armed again in the next tick begins at zero.
TEST(device_loop, forgets_its_wrench_with_the_first_tick_of_a_disarmed_device) {
  control_config control;
  control.limits.force_slew_n_per_s = 200.0;
  rig r(pressing_hand(), control);
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
  simulated_config hand = pressing_hand();
  hand.faults = {{device_fault::nan_pose, 800 * ms, 803 * ms}};
  rig r(hand);
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
      {{}, &broken}, {{pose{}}, vec3(0.0)}, rig::opened(dev), control_config{}, {}, keep_all{&log});
  static_cast<void>(session.run_until(1000 * ms));
  ASSERT_GT(force_of(log.back()), 1.0);
  broken = true;
  static_cast<void>(session.run_until(1010 * ms));
  for (std::size_t i = 1003; i < log.size(); ++i) {
    ASSERT_EQ(log[i].probe_status, status::not_finite) << i;
    EXPECT_EQ(force_of(log[i]), 0.0) << i;
  }
}

// A device that is where it is put, and keeps what it is told.
struct placed_device {
  using policy_tag = device_tag;
  pose T_dh{};
  device_command told{};
  device_capabilities stated = simulated_config{}.capabilities;

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return stated; }
  [[nodiscard]] device_state state() const noexcept { return device_state::active; }
  [[nodiscard]] result<void> open() { return {}; }
  [[nodiscard]] result<void> arm() { return {}; }
  [[nodiscard]] result<void> clear_fault() { return {}; }
  status disarm() noexcept { return status::ok; }
  void close() noexcept {}
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    in.T_dh = T_dh;
    in.host_time_ns = in.device_time_ns = now_ns;
    ++in.sequence;
    in.valid = sample_field::position | sample_field::rotation;
    return status::ok;
  }
  [[nodiscard]] status write(std::int64_t, const device_command& out) noexcept {
    told = out;
    return status::ok;
  }
};

// A tick that comes late moves the probe by longest_step_ns at most: the hand's way since then is no leap of the probe.
// Where the last command has expired the probe stays where it is (gap_test.cpp).
TEST(device_loop, a_late_tick_is_a_tick_of_the_longest_step) {
  const auto after = [](std::int64_t silence_ns) {
    placed_device dev;
    exchange shared;
    std::vector<session_record> log;
    control_config control;
    control.longest_step_ns = 5 * ms;
    device_loop<placed_device, keep_all> loop(dev, control, vec3(0.0), shared, keep_all{&log});
    EXPECT_EQ(loop.tick(0), status::ok);
    dev.T_dh.position = {0.0, 0.01, 0.0};
    EXPECT_EQ(loop.tick(silence_ns), status::ok);
    EXPECT_EQ(dev.told.on_hand.force, log.back().on_hand_d.force);
    EXPECT_EQ(dev.told.valid_until_ns, silence_ns + 20 * ms);
    return log.back();
  };
  const session_record due = after(5 * ms);
  EXPECT_LT(due.on_hand_d.force.y, -0.1);
  for (const std::int64_t late_ns : {6 * ms, 12 * ms, 20 * ms}) {
    const session_record late = after(late_ns);
    EXPECT_EQ(late.T_wa.position, due.T_wa.position) << late_ns;
    EXPECT_EQ(late.on_hand_d.force, due.on_hand_d.force) << late_ns;
  }
}

// After a fault the probe stands where the device is, and not where the wall held it.
TEST(device_loop, begins_anew_at_the_device_when_a_fault_is_cleared) {
  rig r(pressing_hand());
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
  virtual_session<mad_renderer, simulated_device, keep_all> session({}, {{pose{}}, vec3(0.0)}, dev, control_config{},
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
