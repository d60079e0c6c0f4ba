#include <cmath>
#include <gtest/gtest.h>

#include <asperity/hal/simulated/simulated_device.hpp>

namespace {

using namespace asperity;

constexpr std::int64_t ms = 1'000'000;

simulated_device armed(const simulated_config& c) {
  simulated_device d(c);
  EXPECT_TRUE(d.open());
  EXPECT_TRUE(d.arm());
  return d;
}

device_command push(const vec3& force, std::int64_t valid_until_ns) {
  return {{force, vec3(0.0)}, wrench_frame::device_base, valid_until_ns, 1};
}

simulated_config still_hand() {
  simulated_config c;
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
  for (const hand_config& hand : {soft_hand(), hand_config{}, firm_hand()}) {
    simulated_config c;
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
  simulated_config c = still_hand();
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

TEST(simulated_device, quantises_and_delays) {
  simulated_config c;
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

TEST(simulated_device, repeats_itself_to_the_bit) {
  simulated_config c;
  c.motion = {.kind = motion_kind::free};
  c.measurement.jitter_ns = 3 * ms;
  const auto trace = [](const simulated_config& config) {
    simulated_device d = armed(config);
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
  simulated_config c = still_hand();
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

}  // namespace
