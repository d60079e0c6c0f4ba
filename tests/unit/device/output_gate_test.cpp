#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <utility>

#include <asperity/device/output_gate.hpp>

namespace {

using namespace asperity;

constexpr std::int64_t ms = 1'000'000;
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// 10 N and 0.5 N m, 1 N and 0.05 N m per millisecond; continuous limits out of the way.
gate_limits plain() {
  return {.peak_force_n = 10.0,
          .continuous_force_n = 10.0,
          .force_slew_n_per_s = 1000.0,
          .peak_torque_n_m = 0.5,
          .continuous_torque_n_m = 0.5,
          .torque_slew_n_m_per_s = 50.0};
}

device_command want(const vec3& force, const vec3& torque = vec3(0.0)) {
  return {{force, torque}, wrench_frame::device_base, std::numeric_limits<std::int64_t>::max(), 1};
}

struct gate_test : testing::Test {
  output_gate gate{plain()};
  std::int64_t now = 0;

  wrench pass(const device_command& c, std::int64_t step_ns = ms) {
    now += step_ns;
    return gate.pass(now, {}, c).on_hand;
  }
  wrench pass_times(int n, const device_command& c) {
    wrench w;
    for (int i = 0; i < n; ++i) w = pass(c);
    return w;
  }
};

TEST_F(gate_test, starts_at_zero_and_follows_at_the_slew_rate) {
  EXPECT_EQ(pass(want({5, 0, 0})).force, vec3(0.0));
  EXPECT_DOUBLE_EQ(pass(want({5, 0, 0})).force.x, 1.0);
  EXPECT_DOUBLE_EQ(pass_times(3, want({5, 0, 0})).force.x, 4.0);
  EXPECT_DOUBLE_EQ(pass_times(3, want({5, 0, 0})).force.x, 5.0);
  EXPECT_DOUBLE_EQ(pass(want({-5, 0, 0})).force.x, 4.0);
  EXPECT_EQ(gate.fault(), gate_fault::none);
}

TEST_F(gate_test, saturates_force_and_torque_apart_and_keeps_their_directions) {
  const vec3 force{30.0, -40.0, 120.0};
  const vec3 torque{0.3, 0.0, -0.1};
  const wrench w = pass_times(50, want(force, torque));
  EXPECT_NEAR(glm::length(w.force), 10.0, 1e-12);
  EXPECT_NEAR(glm::dot(glm::normalize(w.force), glm::normalize(force)), 1.0, 1e-14);
  EXPECT_LT(glm::length(w.torque - torque), 1e-15);  // within its own limit: untouched
  EXPECT_EQ(gate.fault(), gate_fault::none);
}

TEST_F(gate_test, a_late_tick_saves_up_no_slew) {
  pass_times(2, want({0, 0, 0}));
  EXPECT_NEAR(pass(want({9, 0, 0}), 3000 * ms).force.x, 4.0, 1e-12);  // four milliseconds' worth
}

TEST_F(gate_test, time_that_stands_still_or_runs_back_changes_nothing) {
  pass_times(4, want({9, 0, 0}));
  const wrench before = gate.last();
  EXPECT_EQ(pass(want({-9, 0, 0}), 0).force, before.force);
  EXPECT_EQ(pass(want({-9, 0, 0}), -ms).force, before.force);
}

TEST_F(gate_test, shuts_on_what_is_not_finite) {
  for (const double bad : {nan_value, infinity, -infinity, 1e300, std::numeric_limits<double>::max()}) {
    for (int axis = 0; axis < 6; ++axis) {
      output_gate fresh(plain());
      std::int64_t t = 0;
      for (int i = 0; i < 20; ++i) static_cast<void>(fresh.pass(t += ms, {}, want({3, 4, 0}, {0, 0.3, 0})));
      device_command c = want({3, 4, 0}, {0, 0.3, 0});
      (axis < 3 ? c.on_hand.force[axis] : c.on_hand.torque[axis - 3]) = bad;
      const wrench first = fresh.pass(t += ms, {}, c).on_hand;
      EXPECT_TRUE(is_finite(first));
      EXPECT_EQ(fresh.fault(), gate_fault::not_finite);
      // Zero within peak / slew, and it stays zero although the commands are good again.
      for (int i = 0; i < 10; ++i) static_cast<void>(fresh.pass(t += ms, {}, want({3, 4, 0}, {0, 0.3, 0})));
      EXPECT_TRUE(fresh.at_rest());
    }
  }
}

TEST_F(gate_test, takes_minus_zero_for_zero) {
  const wrench w = pass_times(3, want({-0.0, -0.0, 1.0}));
  EXPECT_EQ(w.force.x, 0.0);
  EXPECT_EQ(gate.fault(), gate_fault::none);
  const wrench rest = pass_times(3, want({-0.0, -0.0, -0.0}));
  EXPECT_EQ(rest.force, vec3(0.0));
  EXPECT_TRUE(gate.at_rest());
}

TEST_F(gate_test, shuts_on_a_stale_command) {
  device_command c = want({5, 0, 0});
  c.valid_until_ns = 10 * ms;
  for (int i = 0; i < 10; ++i) pass(c);
  EXPECT_EQ(gate.fault(), gate_fault::none);
  EXPECT_EQ(now, 10 * ms);
  pass(c);
  EXPECT_EQ(gate.fault(), gate_fault::stale_command);
  pass_times(5, c);
  EXPECT_TRUE(gate.at_rest());
}

TEST_F(gate_test, shuts_on_a_wrong_frame) {
  for (const wrench_frame f : {wrench_frame::unset, wrench_frame::world, wrench_frame::handle}) {
    output_gate fresh(plain());
    device_command c = want({1, 0, 0});
    c.frame = f;
    static_cast<void>(fresh.pass(0, {}, c));
    EXPECT_TRUE(is_finite(fresh.pass(ms, {}, c).on_hand));
    EXPECT_TRUE(fresh.at_rest());
    EXPECT_EQ(fresh.fault(), gate_fault::wrong_frame);
  }
}

TEST_F(gate_test, keeps_the_first_cause_and_opens_at_rest_only) {
  pass_times(6, want({5, 0, 0}));
  gate.trip(gate_fault::stopped);
  gate.trip(gate_fault::device_failed);
  EXPECT_EQ(gate.fault(), gate_fault::stopped);
  EXPECT_FALSE(gate.clear());
  pass_times(6, want({5, 0, 0}));
  EXPECT_TRUE(gate.clear());
  EXPECT_GT(pass_times(2, want({5, 0, 0})).force.x, 0.0);
}

TEST_F(gate_test, remembers_the_last_ticks_before_a_fault) {
  for (int i = 0; i < 100; ++i) pass(want({0.01 * i, 0, 0}));
  pass(want({nan_value, 0, 0}));
  pass_times(10, want({1, 0, 0}));
  const flight_recorder& f = gate.flight();
  ASSERT_EQ(f.size(), 64U);
  EXPECT_TRUE(f.frozen());
  EXPECT_TRUE(std::isnan(f[63].wanted.force.x));
  EXPECT_EQ(f[63].time_ns, 101 * ms);
  EXPECT_EQ(f[0].time_ns, 38 * ms);
  EXPECT_DOUBLE_EQ(f[62].wanted.force.x, 0.99);
}

TEST(bound_vector, certificate_catches_a_previous_value_that_is_not_within_the_limit) {
  for (const double bad : {50.0, nan_value, infinity, 1e300}) {
    for (int axis = 0; axis < 3; ++axis) {
      vec3 previous{0.5, -0.25, 0.125};
      previous[axis] = bad;
      const bounded_vector v = bound_vector({1, 2, 3}, previous, {10.0, 10.0, 1.0}, true);
      EXPECT_FALSE(v.certified);
      EXPECT_EQ(v.value, vec3(0.0));
    }
  }
}

// The certificate's room is for rounding: a millionth over the limit is over it.
TEST(bound_vector, certificate_leaves_room_for_rounding_only) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& [over, certified] : {std::pair{1e-10, true}, std::pair{1e-6, false}, std::pair{0.05, false}}) {
      vec3 previous{0.0};
      previous[axis] = 10.0 * (1.0 + over);
      const bounded_vector v = bound_vector(previous, previous, {10.0, 10.0, 1e-12}, true);
      EXPECT_EQ(v.certified, certified) << over;
      EXPECT_EQ(v.value == vec3(0.0), !certified) << over;
    }
  }
}

TEST(output_gate, limits_that_are_no_numbers_let_nothing_through) {
  for (const double bad : {nan_value, -1.0, 0.0}) {
    gate_limits l = plain();
    l.peak_force_n = bad;
    output_gate gate(l);
    for (int i = 0; i < 20; ++i) static_cast<void>(gate.pass(i * ms, {}, want({1, 2, 3})));
    EXPECT_EQ(gate.last().force, vec3(0.0));
  }
}

TEST(output_gate, takes_each_limit_that_a_device_states_for_what_it_is) {
  device_capabilities stated;
  stated.continuous_force_n = 1.0;
  stated.peak_force_n = 2.0;
  stated.continuous_torque_n_m = 3.0;
  stated.peak_torque_n_m = 4.0;
  stated.force_slew_n_per_s = 5.0;
  stated.torque_slew_n_m_per_s = 6.0;
  const gate_limits l = limits_of(stated);
  EXPECT_EQ(l.continuous_force_n, 1.0);
  EXPECT_EQ(l.peak_force_n, 2.0);
  EXPECT_EQ(l.continuous_torque_n_m, 3.0);
  EXPECT_EQ(l.peak_torque_n_m, 4.0);
  EXPECT_EQ(l.force_slew_n_per_s, 5.0);
  EXPECT_EQ(l.torque_slew_n_m_per_s, 6.0);
}

TEST(output_gate, device_limits_cannot_be_raised) {
  gate_limits generous = plain();
  generous.peak_force_n = 1000.0;
  EXPECT_EQ(tighter(plain(), generous).peak_force_n, 10.0);
  // Nor any other of them, whichever side states the lower one.
  for (double gate_limits::*const which :
       {&gate_limits::peak_force_n, &gate_limits::continuous_force_n, &gate_limits::force_slew_n_per_s,
        &gate_limits::peak_torque_n_m, &gate_limits::continuous_torque_n_m, &gate_limits::torque_slew_n_m_per_s}) {
    gate_limits high = plain();
    high.*which *= 3.0;
    EXPECT_EQ(tighter(plain(), high).*which, plain().*which);
    EXPECT_EQ(tighter(high, plain()).*which, plain().*which);
  }
  device_capabilities unstated;
  EXPECT_EQ(tighter(limits_of(unstated), generous).peak_force_n, 0.0);
}

// Nor made to last: whatever time constant an application states, the running mean square that the device's own limits
// allow, over the device's own time constant, is not passed.
TEST(output_gate, the_devices_thermal_budget_cannot_be_raised) {
  gate_limits device = plain();
  device.continuous_force_n = 4.0;
  device.continuous_torque_n_m = 0.2;
  device.thermal_time_s = 0.5;
  for (const double stated_s : {0.05, 0.5, 5.0, 1e9}) {
    gate_limits application = plain();
    application.thermal_time_s = stated_s;
    output_gate gate(tighter(device, application));
    double force_n2 = 0.0;
    double torque_n2_m2 = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const bool pauses = i % 1000 > 700;
      const wrench w = gate.pass(i * ms, {}, pauses ? want(vec3(0.0)) : want({0, 0, 100}, {5, 0, 0})).on_hand;
      force_n2 += 1e-3 / (0.5 + 1e-3) * (w.force.z * w.force.z - force_n2);
      torque_n2_m2 += 1e-3 / (0.5 + 1e-3) * (w.torque.x * w.torque.x - torque_n2_m2);
      ASSERT_LE(force_n2, 16.0 * (1.0 + 1e-9)) << stated_s << ' ' << i;
      ASSERT_LE(torque_n2_m2, 0.04 * (1.0 + 1e-9)) << stated_s << ' ' << i;
    }
  }
}

// A million commands, poses and limits of any bit pattern: finite, within the limit, no faster than the slew rate.
TEST(output_gate, no_bit_pattern_gets_past) {
  std::mt19937_64 bits(20241);
  output_gate gate(plain());
  std::int64_t t = 0;
  wrench before;
  double largest = 0.0;
  double steepest = 0.0;
  int opened = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    // Half raw bits, half numbers of a likely size: raw bits alone shut the gate nearly always.
    const auto number = [&](double scale) {
      const std::uint64_t b = bits();
      return i % 2 == 0 ? std::bit_cast<double>(b) : scale * (static_cast<double>(b >> 11) * 0x1.0p-52 - 1.0);
    };
    const device_command c{{{number(40), number(40), number(40)}, {number(2), number(2), number(2)}},
                           bits() % 64 == 0 ? wrench_frame::world : wrench_frame::device_base,
                           bits() % 64 == 0 ? t : std::numeric_limits<std::int64_t>::max(),
                           0};
    t += ms;
    const wrench w = gate.pass(t, {}, c).on_hand;
    ASSERT_TRUE(is_finite(w));
    largest = std::max({largest, glm::length(w.force) / 10.0, glm::length(w.torque) / 0.5});
    steepest = std::max({steepest, glm::length(w.force - before.force), glm::length(w.torque - before.torque) / 0.05});
    before = w;
    if (gate.fault() != gate_fault::none && gate.clear()) ++opened;
  }
  EXPECT_LE(largest, 1.0 + 1e-8);
  EXPECT_LE(steepest, 1.0 + 1e-12);
  EXPECT_GT(largest, 0.1);  // something did get through
  EXPECT_GT(opened, 1000);
}

TEST(output_gate, settles_at_the_continuous_limit) {
  gate_limits l = plain();
  l.continuous_force_n = 4.0;
  l.thermal_time_s = 2.0;
  output_gate gate(l);
  double peak = 0.0;
  double largest_mean_square = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    peak = std::max(peak, gate.pass(i * ms, {}, want({100, 0, 0})).on_hand.force.x);
    largest_mean_square = std::max(largest_mean_square, gate.force_mean_square());
  }
  EXPECT_GT(peak, 9.0);  // the peak is there for a short time
  EXPECT_NEAR(gate.last().force.x, 4.0, 0.05);
  EXPECT_LE(largest_mean_square, 16.0);
  EXPECT_EQ(gate.fault(), gate_fault::none);
}

TEST(output_gate, settles_at_the_continuous_torque) {
  gate_limits l = plain();
  l.continuous_torque_n_m = 0.2;
  l.thermal_time_s = 2.0;
  output_gate gate(l);
  double peak = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    peak = std::max(peak, gate.pass(i * ms, {}, want(vec3(0.0), {0, 5, 0})).on_hand.torque.y);
    ASSERT_LE(gate.torque_mean_square(), 0.04);
  }
  EXPECT_GT(peak, 0.45);
  EXPECT_NEAR(gate.last().torque.y, 0.2, 0.0025);
  EXPECT_EQ(gate.fault(), gate_fault::none);
}

// A continuous limit above the peak, as an application may state it, is the peak's: the gate neither lets more through
// as it warms up nor shuts over its own limits.
TEST(output_gate, a_continuous_limit_above_the_peak_changes_nothing) {
  for (const double continuous : {0.5001, 5.0, 1e6}) {
    gate_limits l = plain();
    l.continuous_torque_n_m = continuous;
    l.continuous_force_n = 20.0 * continuous;
    l.thermal_time_s = 0.05;
    output_gate gate(l);
    for (int i = 0; i < 500; ++i) {
      const wrench w = gate.pass(i * ms, {}, want({0, 100, 0}, {0, 0, 100})).on_hand;
      ASSERT_LE(w.force.y, 10.0 * (1.0 + 1e-12)) << continuous;
      ASSERT_LE(w.torque.z, 0.5 * (1.0 + 1e-12)) << continuous;
    }
    EXPECT_NEAR(gate.last().force.y, 10.0, 1e-9) << continuous;
    EXPECT_NEAR(gate.last().torque.z, 0.5, 1e-9) << continuous;
    EXPECT_EQ(gate.fault(), gate_fault::none) << continuous;
  }
}

// How long a device with a watchdog of its own goes on with what it was told last.
TEST(output_gate, a_command_is_valid_for_as_long_as_was_said_and_no_longer) {
  for (const std::int64_t hold_ns : {ms, 7 * ms, 20 * ms}) {
    output_gate gate(plain(), hold_ns);
    for (int i = 0; i < 5; ++i) {
      const device_command c = gate.pass(i * ms, {}, want({1, 0, 0}));
      EXPECT_EQ(c.valid_until_ns, i * ms + hold_ns);
      EXPECT_EQ(c.frame, wrench_frame::device_base);
      EXPECT_EQ(c.sequence, static_cast<std::uint64_t>(i) + 1U);
    }
  }
  output_gate by_default(plain());
  EXPECT_EQ(by_default.pass(3 * ms, {}, want({1, 0, 0})).valid_until_ns, 23 * ms);
}

TEST(output_gate, warms_with_its_time_constant) {
  gate_limits l = plain();
  l.thermal_time_s = 2.0;
  output_gate gate(l);
  for (int i = 0; i < 2000; ++i) static_cast<void>(gate.pass(i * ms, {}, want({3.0, 0, 0})));
  EXPECT_NEAR(gate.force_mean_square(), 9.0 * (1.0 - std::exp(-1.0)), 0.02);
}

TEST(output_gate, derates_nothing_below_the_continuous_limit) {
  gate_limits l = plain();
  l.continuous_force_n = 4.0;
  output_gate gate(l);
  for (int i = 0; i < 100'000; ++i) static_cast<void>(gate.pass(i * ms, {}, want({3.9, 0, 0})));
  EXPECT_DOUBLE_EQ(gate.last().force.x, 3.9);
}

TEST(output_gate, low_pass_takes_its_time_and_nothing_of_what_is_not_finite) {
  gate_limits l = plain();
  l.force_slew_n_per_s = 1e5;
  l.torque_slew_n_m_per_s = 1e5;
  constexpr double cut_off_hz = 10.0;
  output_gate gate(l, 20 * ms, cut_off_hz);
  // A step reaches 1 - 1/e after one time constant, 15.9 ms.
  double at_tau = 0.0;
  for (int i = 0; i <= 16; ++i) at_tau = gate.pass(i * ms, {}, want({6, 0, 0}, {0, 0.3, 0})).on_hand.force.x;
  EXPECT_NEAR(at_tau, 6.0 * (1.0 - std::exp(-16.0e-3 * 2.0 * 3.14159265 * cut_off_hz)), 0.15);
  for (int i = 17; i < 300; ++i) at_tau = gate.pass(i * ms, {}, want({6, 0, 0}, {0, 0.3, 0})).on_hand.force.x;
  EXPECT_NEAR(at_tau, 6.0, 1e-6);

  // NaN, then a fault, then a person: what comes afterwards starts from zero, and is not NaN.
  EXPECT_LT(gate.pass(300 * ms, {}, want({nan_value, 0, 0})).on_hand.force.x, 6.0);
  EXPECT_EQ(gate.fault(), gate_fault::not_finite);
  EXPECT_EQ(gate.fault_time_ns(), 300 * ms);
  EXPECT_EQ(gate.pass(301 * ms, {}, want({6, 0, 0})).on_hand.force, vec3(0.0));  // zero does not wait for the filter
  ASSERT_TRUE(gate.clear());
  const double first = gate.pass(302 * ms, {}, want({6, 0, 0})).on_hand.force.x;
  EXPECT_GT(first, 0.0);
  EXPECT_LT(first, 0.5);
  for (const double bad : {nan_value, infinity, -infinity, 1e300}) {
    output_gate fresh(l, 20 * ms, cut_off_hz);
    for (int i = 0; i < 20; ++i) {
      EXPECT_TRUE(is_finite(fresh.pass(i * ms, {}, want({i == 10 ? bad : 1.0, 0, 0})).on_hand));
    }
    EXPECT_EQ(fresh.fault(), gate_fault::not_finite);
  }
}

// Force and torque pass the same filter: the torque's part of the way is the force's, in every tick.
TEST(output_gate, low_passes_the_torque_as_the_force) {
  gate_limits l = plain();
  l.force_slew_n_per_s = l.torque_slew_n_m_per_s = 1e5;
  output_gate gate(l, 20 * ms, 10.0);
  for (int i = 0; i <= 30; ++i) {
    const wrench w = gate.pass(i * ms, {}, want({0, 6, 0}, {0, 0.3, 0})).on_hand;
    EXPECT_NEAR(w.torque.y, 0.05 * w.force.y, 1e-15) << i;
    if (i == 16) {
      EXPECT_NEAR(w.torque.y, 0.3 * (1.0 - std::exp(-16.0e-3 * 2.0 * 3.14159265 * 10.0)), 0.0075);
    }
  }
}

// What is no ordinary number is found as it came, and stays nowhere: cleared in the same tick, the gate follows again.
TEST(output_gate, a_low_pass_keeps_nothing_of_what_shut_the_gate) {
  for (const double bad : {nan_value, infinity, 2e150, -2e150}) {
    for (int axis = 0; axis < 6; ++axis) {
      output_gate gate(plain(), 20 * ms, 10.0);
      static_cast<void>(gate.pass(0, {}, want(vec3(0.0))));
      device_command c = want(vec3(0.0));
      (axis < 3 ? c.on_hand.force[axis] : c.on_hand.torque[axis - 3]) = bad;
      EXPECT_TRUE(is_zero(gate.pass(ms, {}, c).on_hand));
      ASSERT_EQ(gate.fault(), gate_fault::not_finite) << bad << ' ' << axis;
      ASSERT_TRUE(gate.clear());
      const wrench w = gate.pass(2 * ms, {}, want({6, 0, 0}, {0, 0.3, 0})).on_hand;
      EXPECT_EQ(gate.fault(), gate_fault::none) << bad << ' ' << axis;
      EXPECT_GT(w.force.x, 0.0);
      EXPECT_GT(w.torque.y, 0.0);
    }
  }
}

TEST(output_gate, a_low_pass_without_a_cut_off_is_shut) {
  for (const double cut_off_hz : {0.0, -1.0, nan_value}) {
    output_gate gate(plain(), 20 * ms, cut_off_hz);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(gate.pass(i * ms, {}, want({6, 0, 0})).on_hand.force, vec3(0.0));
    EXPECT_EQ(gate.fault(), gate_fault::none);
  }
}

TEST(output_gate, zero_is_reached_within_the_time_that_is_stated) {
  std::mt19937_64 bits(7);
  const auto draw = [&](double low, double high) {
    return low * std::pow(high / low, static_cast<double>(bits() >> 11) * 0x1.0p-53);
  };
  for (int i = 0; i < 2000; ++i) {
    gate_limits l = plain();
    l.peak_force_n = l.continuous_force_n = draw(0.1, 100.0);
    l.peak_torque_n_m = l.continuous_torque_n_m = draw(0.01, 10.0);
    l.force_slew_n_per_s = draw(10.0, 1e5);
    l.torque_slew_n_m_per_s = draw(1.0, 1e4);
    const auto period = static_cast<std::int64_t>(draw(1e5, 2e7));
    output_gate gate(l);
    std::int64_t now = 0;
    const std::int64_t stated = time_to_zero_ns(l, period);
    for (std::int64_t t = 0; t <= stated; t += period) {
      static_cast<void>(gate.pass(now += period, {}, want({1e9, 1e9, 0}, {0, 1e9, 1e9})));
    }
    ASSERT_FALSE(gate.at_rest());
    gate.trip(gate_fault::stopped);
    const std::int64_t begin = now;
    while (!gate.at_rest()) static_cast<void>(gate.pass(now += period, {}, want({1e9, 0, 0})));
    ASSERT_LE(now - begin, stated);
    ASSERT_GE(now - begin, stated - 2 * period) << "stated far too long";
  }
  gate_limits stuck = plain();
  stuck.force_slew_n_per_s = 0.0;
  EXPECT_EQ(time_to_zero_ns(stuck, ms), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(time_to_zero_ns(gate_limits{}, ms), ms);
}

TEST(output_gate, every_cause_has_its_own_words) {
  for (int a = 0; a < gate_fault_count; ++a) {
    EXPECT_STRNE(to_string(static_cast<gate_fault>(a)), "unknown fault");
    for (int b = 0; b < a; ++b)
      EXPECT_STRNE(to_string(static_cast<gate_fault>(a)), to_string(static_cast<gate_fault>(b)));
  }
}

}  // namespace
