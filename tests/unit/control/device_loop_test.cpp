// What a device loop feels like: where the probe is, what the hand gets, and within which limits.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
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

TEST(device_loop, starts_the_probe_at_the_device_without_a_jump) {
  simulated_settings hand = pressing_hand();
  hand.motion.T_dh.position = {0.3, -0.2, 0.1};
  hand.motion.T_dh.rotation = exp_rotation({0.3, 0.1, -1.0});
  wall_session r(hand);
  r.run_ms(20);
  EXPECT_LT(glm::length(r.log[0].T_wa.position - r.log[0].T_wa_target.position), 1e-12);
  EXPECT_EQ(force_of(r.log[0]), 0.0);
  for (const session_record& t : r.log) EXPECT_LT(force_of(t), 0.05);
}

TEST(device_loop, pushes_back_where_hand_coupling_and_wall_balance) {
  wall_session r(pressing_hand());
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
  virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{});
  static_cast<void>(session.run_until(1000 * ms));
  EXPECT_EQ(dev.state(), device_state::ready);
  EXPECT_EQ(dev.delivered_j(), 0.0);
}

// The handle carries a probe whose centre of mass is off its axis, in a workspace that is turned and scaled: the hand
// feels the wall's force along the device's own axes, and the torque of the lever.
TEST(device_loop, maps_frames_and_levers) {
  simulated_settings hand;
  hand.motion = {.T_dh = {quat(1, 0, 0, 0), {0, 0, 0.005}}, .direction_d = {1, 0, 0}, .depth_m = 0.012};
  hand.hand.stiffness_n_m_per_rad = 1e3;  // a grip that does not turn
  control_settings control;
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
    simulated_settings hand;
    hand.motion = {
        .kind = motion_kind::scrub, .depth_m = 0.0, .approach_s = 0.01, .amplitude_m = 0.0005, .frequency_hz = 40.0};
    hand.hand = {.stiffness_n_per_m = 2e4, .damping_n_s_per_m = 50.0};
    control_settings control;
    control.substeps = substeps;
    wall_session r(hand, control);
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

// Armed while the hand already presses: the wrench grows from zero at the slew rate. Found by simulation.
TEST(device_loop, begins_at_zero_when_it_is_armed_in_contact) {
  control_settings control;
  control.limits.force_slew_n_per_s = 200.0;
  wall_session r(pressing_hand(), control);
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

// A loop that stands still: the device, which holds the last command, lets go 20 ms after it.
TEST(device_loop, a_loop_that_stands_still_is_forgotten_by_the_device) {
  wall_session r(pressing_hand());
  r.run_ms(1000);
  ASSERT_GT(force_of(r.last()), 1.0);
  const std::int64_t commanded_at_ns = r.last().time_ns;
  wrench held;
  ASSERT_EQ(r.dev.applied(commanded_at_ns + 20 * ms, held), status::ok);
  EXPECT_EQ(held.force, r.last().on_hand_d.force);
  ASSERT_EQ(r.dev.applied(commanded_at_ns + 20 * ms + 1, held), status::ok);
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
  control_settings control;
  control.limits.peak_force_n = 0.7;
  wall_session r(pressing_hand(), control);
  r.run_ms(1500);
  double largest = 0.0;
  for (const session_record& t : r.log) largest = std::max(largest, force_of(t));
  EXPECT_NEAR(largest, 0.7, 1e-9);
}

// The device's own limits hold although the application states none.
TEST(device_loop, keeps_within_what_the_device_states_of_itself) {
  simulated_settings hand = pressing_hand();
  hand.capabilities.peak_force_n = hand.capabilities.continuous_force_n = 0.6;
  hand.capabilities.force_slew_n_per_s = 20.0;
  wall_session r(hand);
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

}  // namespace
