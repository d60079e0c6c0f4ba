#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>

#include <asperity/device/simulated/simulated_device.hpp>

namespace {

using namespace asperity;

constexpr std::int64_t ms = 1'000'000;

simulated_device armed(const simulated_settings& c) {
  simulated_device d(c);
  EXPECT_TRUE(d.open());
  EXPECT_TRUE(d.arm());
  return d;
}

device_command push(const vec3& force, std::int64_t valid_until_ns) {
  return {{force, vec3(0.0)}, wrench_frame::device_base, valid_until_ns, 1};
}

simulated_settings still_hand() {
  simulated_settings c;
  c.motion.depth_m = 0.0;
  c.hand.tremor_m = 0.0;
  return c;
}

TEST(simulated_device, goes_through_its_states) {
  simulated_device d;
  device_sample s;
  EXPECT_EQ(d.state(), device_state::absent);
  EXPECT_EQ(d.read(0, s), status::not_ready);
  const result<void> early = d.arm();
  ASSERT_FALSE(early);
  EXPECT_NE(early.error().message.find("absent"), std::string::npos);
  ASSERT_TRUE(d.open());
  EXPECT_EQ(d.state(), device_state::ready);
  EXPECT_FALSE(d.open());
  ASSERT_TRUE(d.arm());
  EXPECT_EQ(d.state(), device_state::armed);
  EXPECT_EQ(d.write(ms, push({1, 0, 0}, 100 * ms)), status::ok);
  EXPECT_EQ(d.state(), device_state::active);
  EXPECT_EQ(d.write(2 * ms, push({0, 0, 0}, 100 * ms)), status::ok);
  EXPECT_EQ(d.state(), device_state::armed);
  EXPECT_EQ(d.disarm(), status::ok);
  EXPECT_EQ(d.state(), device_state::ready);
  d.close();
  EXPECT_EQ(d.state(), device_state::closed);
  ASSERT_TRUE(d.open());
  EXPECT_EQ(d.state(), device_state::ready);
}

// Hand spring against a constant force: the static deflection is known.
TEST(simulated_device, is_deflected_as_hand_and_force_say) {
  simulated_device d = armed(still_hand());
  device_sample s;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(d.read(i * ms, s), status::ok);
    ASSERT_EQ(d.write(i * ms, push({3.0, 0, 0}, (i + 20) * ms)), status::ok);
  }
  EXPECT_NEAR(s.T_dh.position.x, 3.0 / 300.0, 2e-6);
  EXPECT_NEAR(d.delivered_j(), 3.0 * 3.0 / 300.0, 2e-5);
}

// Free plant without damping: a force held for t moves it by F t^2 / 2m.
// What went in is in the dampers, in the plant's motion, or was taken out by the implicit step: nothing else.
TEST(simulated_device, closes_the_energy_book_of_its_plant) {
  for (const hand_settings& hand : {soft_hand(), hand_settings{}, firm_hand()}) {
    simulated_settings c;
    c.motion = {.kind = motion_kind::free, .amplitude_m = 0.02, .amplitude_rad = 0.5, .frequency_hz = 3.0};
    c.hand = hand;
    simulated_device d = armed(c);
    device_sample s;
    for (int i = 0; i < 2000; ++i) {
      ASSERT_EQ(d.read(i * ms, s), status::ok);
      const double a = 0.05 * i;
      const wrench w{{2.0 * std::sin(a), std::cos(0.3 * a), -1.0}, {0.01 * std::cos(a), 0.02, 0.03 * std::sin(a)}};
      ASSERT_EQ(d.write(i * ms, {w, wrench_frame::device_base, i * ms + 10 * ms, 1}), status::ok);
      const plant_energy& e = d.energy();
      ASSERT_NEAR(e.by_device_j + e.by_hand_j - e.damped_j - e.numerical_j, d.kinetic_j(), 1e-11);
    }
    EXPECT_EQ(d.delivered_j(), d.energy().by_device_j);
    EXPECT_GT(d.energy().damped_j, 1e-3);
    EXPECT_LT(d.energy().numerical_j, 0.1 * d.energy().damped_j);
  }
}

TEST(simulated_device, moves_as_newton_says) {
  simulated_settings c = still_hand();
  c.hand = {0.0, 0.0, 0.0, 0.0, 0.0};
  c.plant = {.mass_kg = 0.2, .damping_n_s_per_m = 0.0, .inertia_kg_m2 = 1e-3, .damping_n_m_s_per_rad = 0.0};
  simulated_device d = armed(c);
  device_sample s;
  ASSERT_EQ(d.read(0, s), status::ok);
  device_command cmd = push({0.4, 0, 0}, 1000 * ms);
  cmd.on_hand.torque = {0, 0, 1e-3};
  ASSERT_EQ(d.write(0, cmd), status::ok);
  ASSERT_EQ(d.read(200 * ms, s), status::ok);
  EXPECT_NEAR(s.T_dh.position.x, 0.5 * 2.0 * 0.04, 2e-5);
  EXPECT_NEAR(log_rotation(s.T_dh.rotation).z, 0.5 * 1.0 * 0.04, 2e-5);
  EXPECT_NEAR(s.velocity_d.linear.x, 0.4, 1e-9);
}

TEST(simulated_device, lets_go_when_the_host_falls_silent) {
  simulated_device d = armed(still_hand());
  device_sample s;
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(d.read(i * ms, s), status::ok);
    ASSERT_EQ(d.write(i * ms, push({3.0, 0, 0}, (i + 20) * ms)), status::ok);
  }
  ASSERT_EQ(d.read(2000 * ms, s), status::ok);
  EXPECT_NEAR(s.T_dh.position.x, 0.0, 1e-5);
}

TEST(simulated_device, puts_nothing_out_unless_armed) {
  simulated_device d(still_hand());
  ASSERT_TRUE(d.open());
  device_sample s;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(d.read(i * ms, s), status::ok);
    ASSERT_EQ(d.write(i * ms, push({10, 0, 0}, 1000 * ms)), status::ok);
  }
  EXPECT_EQ(s.T_dh.position.x, 0.0);
}

TEST(simulated_device, faults_on_a_command_that_no_gate_would_send) {
  simulated_device d = armed(still_hand());
  EXPECT_EQ(d.write(0, push({std::nan(""), 0, 0}, ms)), status::not_finite);
  EXPECT_EQ(d.state(), device_state::fault);
  EXPECT_FALSE(d.arm());
  ASSERT_TRUE(d.clear_fault());
  EXPECT_EQ(d.state(), device_state::closed);

  simulated_device e = armed(still_hand());
  device_command world = push({1, 0, 0}, ms);
  world.frame = wrench_frame::world;
  EXPECT_EQ(e.write(0, world), status::not_finite);
}

// What no gate would send is cut down to what the device states of itself, force and torque apart, direction kept.
TEST(simulated_device, puts_out_no_more_than_it_states) {
  simulated_settings c = still_hand();
  c.capabilities.peak_force_n = 5.0;
  c.capabilities.peak_torque_n_m = 0.5;
  simulated_device d = armed(c);
  device_sample s;
  ASSERT_EQ(d.read(0, s), status::ok);
  for (const double times : {0.5, 1.0, 3.0, 1e300}) {
    const wrench wanted{times * vec3(3, 0, 4), times * vec3(0, -0.3, 0.4)};
    ASSERT_EQ(d.write(0, {wanted, wrench_frame::device_base, 20 * ms, 1}), status::ok);
    wrench w;
    ASSERT_EQ(d.applied(0, w), status::ok);
    EXPECT_LT(glm::length(w.force - std::min(times, 1.0) * vec3(3, 0, 4)), 1e-14) << times;
    EXPECT_LT(glm::length(w.torque - std::min(times, 1.0) * vec3(0, -0.3, 0.4)), 1e-15) << times;
  }
}

TEST(simulated_device, quantises_and_delays) {
  simulated_settings c;
  c.motion = {.direction_d = {1, 0, 0}, .depth_m = 0.1};
  c.measurement = {.position_resolution_m = 1e-4, .delay_ns = 5 * ms};
  simulated_device d = armed(c);
  device_sample s;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(d.read(i * ms, s), status::ok);
    const double steps = s.T_dh.position.x / 1e-4;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
  EXPECT_EQ(s.host_time_ns - s.device_time_ns, 5 * ms);
  EXPECT_LT(s.T_dh.position.x, d.true_T_dh().position.x - 0.0002);
}

// A person's hand that comes by jumps, as a mouse tells it: smooth, never faster than an arm, and there in the end.
TEST(simulated_device, is_led_where_it_is_wanted) {
  simulated_settings c = still_hand();
  c.motion.T_dh.position = {0.01, 0.0, 0.02};
  c.lead = std::make_shared<hand_lead>();
  simulated_device d = armed(c);
  device_sample s;
  std::int64_t now = 0;
  const auto go = [&](std::int64_t time_ns, auto&& look) {
    for (const std::int64_t until = now + time_ns; now < until; now += ms) {
      ASSERT_EQ(d.read(now, s), status::ok);
      look();
    }
  };
  go(200 * ms, [&] { EXPECT_LT(glm::distance(s.T_dh.position, c.motion.T_dh.position), 1e-6) << "nobody has led it"; });
  const pose first{exp_rotation({0.0, 0.9, 0.0}), {0.06, -0.03, 0.02}};
  c.lead->lead_to(first);
  double fastest_m_per_s = 0.0, fastest_rad_per_s = 0.0, furthest_m = 0.0;
  vec3 last = d.true_T_dh().position;
  double steepest = 0.0;
  vec3 last_velocity(0.0);
  go(800 * ms, [&] {
    const vec3 velocity = d.true_velocity_d().linear;
    fastest_m_per_s = std::max(fastest_m_per_s, glm::length(velocity));
    fastest_rad_per_s = std::max(fastest_rad_per_s, glm::length(d.true_velocity_d().angular));
    furthest_m = std::max(furthest_m, glm::dot(d.true_T_dh().position - last, glm::normalize(first.position - last)));
    steepest = std::max(steepest, glm::length(velocity - last_velocity) / 1e-3);
    last_velocity = velocity;
  });
  EXPECT_LT(glm::distance(s.T_dh.position, first.position), 1e-5);
  EXPECT_LT(glm::length(log_rotation(s.T_dh.rotation * glm::conjugate(first.rotation))), 1e-3);
  EXPECT_GT(fastest_m_per_s, 0.25);
  // The handle swings about the place that the hand's spring pulls it to.
  EXPECT_LT(fastest_m_per_s, 1.4 * led_motion::fastest_m_per_s);
  EXPECT_LT(fastest_rad_per_s, 1.4 * led_motion::fastest_rad_per_s);
  EXPECT_LT(furthest_m, 1.2 * glm::distance(first.position, last));
  EXPECT_LT(steepest, 60.0) << "m/s2: no jump of the target is one of the hand";
  // The newest counts, and what is told later is where it goes.
  c.lead->lead_to({quat(1, 0, 0, 0), {1.0, 0.0, 0.0}});
  c.lead->lead_to(c.motion.T_dh);
  go(1000 * ms, [] {});
  EXPECT_LT(glm::distance(s.T_dh.position, c.motion.T_dh.position), 1e-5);
}

TEST(simulated_device, is_led_without_overshoot_and_no_faster_than_an_arm) {
  for (const double h_s : {5e-5, 1e-3, 0.02}) {
    for (const double way_m : {1e-4, 0.01, 0.5}) {
      led_motion led(pose{});
      const pose goal{exp_rotation({0.0, 0.0, 2.0 * way_m}), {way_m, 0.0, 0.0}};
      double furthest_m = 0.0;
      for (double t_s = 0.0; t_s < 2.0; t_s += h_s) {
        const hand_target& now = led.follow(goal, h_s);
        EXPECT_LE(glm::length(now.velocity_d.linear), led_motion::fastest_m_per_s * (1.0 + 1e-12));
        EXPECT_LE(glm::length(now.velocity_d.angular), led_motion::fastest_rad_per_s * (1.0 + 1e-12));
        furthest_m = std::max(furthest_m, now.T_dh.position.x);
      }
      EXPECT_NEAR(led.now().T_dh.position.x, way_m, 1e-6) << h_s;
      EXPECT_NEAR(log_rotation(led.now().T_dh.rotation).z, 2.0 * way_m, 1e-6) << h_s;
      EXPECT_LT(furthest_m, way_m + led_motion::fastest_m_per_s * std::max(h_s, 0.5 * led_motion::follows_s)) << h_s;
    }
  }
}

TEST(simulated_device, repeats_itself_to_the_bit) {
  simulated_settings c;
  c.motion = {.kind = motion_kind::free};
  c.measurement.jitter_ns = 3 * ms;
  const auto trace = [](const simulated_settings& settings) {
    simulated_device d = armed(settings);
    device_sample s;
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) {
      EXPECT_EQ(d.read(i * ms, s), status::ok);
      EXPECT_EQ(d.write(i * ms, push({-100.0 * s.T_dh.position.x, 0, 0}, (i + 5) * ms)), status::ok);
      sum = sum * 1.0001 + s.T_dh.position.x + s.T_dh.rotation.y;
    }
    return sum;
  };
  const double first = trace(c);
  EXPECT_EQ(trace(c), first);
  c.seed = 2;
  EXPECT_NE(trace(c), first);
}

TEST(simulated_device, leaves_its_bus_and_comes_back_unarmed) {
  simulated_settings c = still_hand();
  c.faults = {{device_fault::depart, 10 * ms, 11 * ms}};
  simulated_device d = armed(c);
  device_sample s;
  for (int i = 0; i < 20; ++i) static_cast<void>(d.read(i * ms, s));
  EXPECT_EQ(d.state(), device_state::fault);
  EXPECT_EQ(d.read(20 * ms, s), status::not_ready);
  EXPECT_FALSE(d.open());
  d.plug_in();
  EXPECT_EQ(d.state(), device_state::fault);
  ASSERT_TRUE(d.clear_fault());
  ASSERT_TRUE(d.open());
  EXPECT_EQ(d.state(), device_state::ready);
}

TEST(simulated_device, motors_hold_their_own_limits_and_slew) {
  simulated_settings settings;
  settings.actuator = {.peak_force_n = 3.0, .force_slew_n_per_s = 1000.0};
  simulated_device dev = armed(settings);
  vec3 before{0.0};
  for (std::int64_t t = 0; t < 20'000'000; t += 50'000) {  // every step of the plant
    device_sample in;
    ASSERT_EQ(dev.read(t, in), status::ok);
    ASSERT_EQ(dev.write(t, push({6, 8, 0}, t + 20 * ms)), status::ok);
    EXPECT_LE(glm::length(dev.put_out().force - before), 0.05 + 1e-12);
    before = dev.put_out().force;
  }
  EXPECT_NEAR(before.x, 1.8, 1e-9);
  EXPECT_NEAR(before.y, 2.4, 1e-9);
}

TEST(simulated_device, motors_hold_their_own_torque_and_its_slew) {
  simulated_settings settings = still_hand();
  settings.actuator = {.peak_torque_n_m = 0.03, .torque_slew_n_m_per_s = 10.0};
  simulated_device dev = armed(settings);
  vec3 before{0.0};
  for (std::int64_t t = 0; t < 20'000'000; t += 50'000) {
    device_sample in;
    ASSERT_EQ(dev.read(t, in), status::ok);
    const wrench commanded{vec3(0.0), {0.0, 0.06, -0.08}};
    ASSERT_EQ(dev.write(t, {commanded, wrench_frame::device_base, t + 20 * ms, 1}), status::ok);
    EXPECT_LE(glm::length(dev.put_out().torque - before), 0.0005 + 1e-12);
    before = dev.put_out().torque;
  }
  EXPECT_NEAR(before.y, 0.018, 1e-12);
  EXPECT_NEAR(before.z, -0.024, 1e-12);
}

TEST(simulated_device, motors_warm_up_and_derate) {
  simulated_settings settings;
  settings.actuator = {.peak_force_n = 10.0, .continuous_force_n = 4.0, .thermal_time_s = 0.5};
  simulated_device dev = armed(settings);
  double at_first = 0.0, least = 10.0;
  device_sample in;
  std::int64_t t = 0;
  for (; t < 5'000'000'000 && dev.read(t, in) == status::ok; t += 1'000'000) {
    static_cast<void>(dev.write(t, push({10, 0, 0}, t + 20 * ms)));
    if (t == 10'000'000) at_first = dev.put_out().force.x;
    if (t > 10'000'000) least = std::min(least, dev.put_out().force.x);
  }
  // Never hot enough to burn while it derates: it settles where the force it still has keeps it warm.
  EXPECT_NEAR(at_first, 10.0, 1e-9);
  EXPECT_LT(least, 6.0);
  EXPECT_GT(dev.actuator().warmth(), 1.0);
  EXPECT_LT(dev.actuator().warmth(), 2.0);
  EXPECT_EQ(dev.state(), device_state::active);

  settings.actuator.derate_from = 1.99;  // a device without foresight
  simulated_device careless = armed(settings);
  for (t = 0; t < 5'000'000'000 && careless.read(t, in) == status::ok; t += 1'000'000) {
    static_cast<void>(careless.write(t, push({10, 0, 0}, t + 20 * ms)));
  }
  EXPECT_LT(careless.actuator().warmth(), 2.1);
}

TEST(simulated_device, motors_that_burn_end_in_a_fault) {
  simulated_settings settings = still_hand();
  settings.actuator = {.continuous_force_n = 4.0,
                       .thermal_time_s = 0.5};  // no peak of their own that could fall in time
  simulated_device dev = armed(settings);
  device_sample in;
  std::int64_t t = 0;
  for (; t < 5'000 * ms && dev.read(t, in) == status::ok; t += ms) {
    static_cast<void>(dev.write(t, push({10, 0, 0}, t + 20 * ms)));
  }
  // The warmth goes to (10 / 4)^2 = 6.25, and is 2 after 0.5 s ln(6.25 / 4.25).
  EXPECT_NEAR(1e-9 * static_cast<double>(t), 0.5 * std::log(6.25 / 4.25), 2e-3);
  EXPECT_GE(dev.actuator().warmth(), 2.0);
  EXPECT_EQ(dev.state(), device_state::fault);
  EXPECT_NE(dev.write(t, push({10, 0, 0}, t + 20 * ms)), status::ok);
  EXPECT_NE(dev.read(t + ms, in), status::ok);
  EXPECT_EQ(dev.put_out().force, vec3(0.0));

  // It cools, and is still in its fault until a person clears it.
  for (const std::int64_t end = t + 2'000 * ms; t < end; t += ms) static_cast<void>(dev.read(t, in));
  EXPECT_LT(dev.actuator().warmth(), 1.0);
  EXPECT_EQ(dev.state(), device_state::fault);
  EXPECT_TRUE(dev.clear_fault());
}

TEST(simulated_device, loses_measurements_and_says_how_many) {
  simulated_settings settings;
  settings.measurement.loss = 0.25;
  simulated_device dev = armed(settings);
  std::uint64_t news = 0, last = 0, gaps = 0;
  device_sample in;
  for (std::int64_t t = 0; t < 4000; ++t) {
    ASSERT_EQ(dev.read(t * 1'000'000, in), status::ok);
    if (in.sequence == last) continue;
    gaps += in.sequence - last - 1;
    last = in.sequence;
    ++news;
  }
  EXPECT_EQ(gaps, in.lost);
  EXPECT_NEAR(static_cast<double>(in.lost), 1000.0, 100.0);
  EXPECT_NEAR(static_cast<double>(news), 3000.0, 100.0);
}

TEST(simulated_device, one_axis_sticks_and_the_others_go_on) {
  simulated_settings settings;
  settings.motion = {.kind = motion_kind::scrub, .depth_m = 0.05, .approach_s = 0.05, .amplitude_m = 0.02};
  settings.faults = {{device_fault::stuck_encoder, 500'000'000, 800'000'000}};
  simulated_device dev = armed(settings);
  device_sample in, at_begin;
  double x_range = 0.0;
  for (std::int64_t t = 0; t < 1000; ++t) {
    ASSERT_EQ(dev.read(t * 1'000'000, in), status::ok);
    if (t == 499) at_begin = in;
    if (t < 500 || t >= 800) continue;
    EXPECT_EQ(in.T_dh.position.x, at_begin.T_dh.position.x);
    x_range = std::max(x_range, std::fabs(dev.true_T_dh().position.x - at_begin.T_dh.position.x));
  }
  EXPECT_GT(x_range, 1e-3);
  EXPECT_NE(in.T_dh.position.x, at_begin.T_dh.position.x);
}

TEST(simulated_device, answers_slowly) {
  simulated_settings settings;
  settings.faults = {{device_fault::slow_reply, 100'000'000, 200'000'000}};
  simulated_device dev = armed(settings);
  std::uint64_t last = 0;
  int news = 0;
  for (std::int64_t t = 0; t < 200; ++t) {
    device_sample in;
    ASSERT_EQ(dev.read(t * 1'000'000, in), status::ok);
    if (t >= 100 && in.sequence != last) ++news;
    last = in.sequence;
  }
  EXPECT_EQ(news, 12);  // at 107 ms and every 8 ms from there
}

TEST(simulated_device, returns_under_another_path_and_unarmed) {
  simulated_settings settings;
  settings.faults = {{device_fault::depart, 5'000'000, 6'000'000}};
  simulated_device dev(settings);
  ASSERT_TRUE(dev.open());
  EXPECT_EQ(dev.path(), "simulated:0");
  device_sample in;
  EXPECT_EQ(dev.read(5'000'000, in), status::not_ready);
  EXPECT_EQ(dev.state(), device_state::absent);
  dev.plug_in();
  EXPECT_EQ(dev.path(), "simulated:1");
  EXPECT_EQ(dev.state(), device_state::present);
  EXPECT_FALSE(dev.arm());
  ASSERT_TRUE(dev.open());
  EXPECT_EQ(dev.state(), device_state::ready);
}

}  // namespace
