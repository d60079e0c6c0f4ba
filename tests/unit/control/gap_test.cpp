// A device loop that stands still: what the hand gets afterwards, on the virtual clock.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include <asperity/control/contact_loop.hpp>
#include <asperity/control/device_loop.hpp>

#include "session/simulation/stall/scripted_device.hpp"
#include "unit/control/wall_session.hpp"

namespace gap_test {

using namespace asperity;
using simulation::hand_script;
using simulation::motor_entry;
using simulation::scripted_device;

constexpr std::int64_t ms = 1'000'000;

device_capabilities strong() {
  device_capabilities c;
  c.peak_force_n = c.continuous_force_n = 20.0;
  c.force_slew_n_per_s = 2000.0;
  c.peak_torque_n_m = c.continuous_torque_n_m = 1.0;
  c.torque_slew_n_m_per_s = 100.0;
  c.device_side_watchdog = true;
  return c;
}

// A hand that is 5 mm under the surface after half a second, and goes on sideways.
hand_script pressing() {
  return {.above_m = 0.002, .depth_m = 0.005, .press_hz = 1.0, .scrub_m = 0.02, .scrub_hz = 0.5, .turn_rad = 0.0};
}

template <class Renderer>
struct rig {
  scripted_device dev;
  exchange shared{};
  contact_loop<Renderer> contact;
  device_loop<scripted_device> loop;

  explicit rig(const hand_script& hand, const device_capabilities& c = strong(), control_settings control = {},
               Renderer feel = {})
      : dev(hand, c),
        contact(feel, {{pose{}}, vec3(0.0)}, shared),
        loop((static_cast<void>(dev.open()), static_cast<void>(dev.arm()), dev), with_periods(control, {}), vec3(0.0),
             shared) {}

  void tick(std::int64_t at_ns) {
    static_cast<void>(contact.tick(at_ns));
    static_cast<void>(loop.tick(at_ns));
  }
  void run(std::int64_t from_ms, std::int64_t until_ms) {
    for (std::int64_t t = from_ms; t < until_ms; ++t) tick(t * ms);
  }
  [[nodiscard]] double force_n() const { return glm::length(dev.motors().back().out.force); }
};

using wall_rig = rig<test_support::analytic_wall>;

TEST(gap, of_a_valid_command_goes_on) {
  wall_rig r(pressing());
  r.run(0, 400);
  const double before_n = r.force_n();
  ASSERT_GT(before_n, 1.0);
  r.tick(419 * ms);  // 20 ms after the last one: the command was valid to the end
  EXPECT_GT(r.force_n(), 0.8 * before_n);
  EXPECT_EQ(r.loop.rates().report().lapses, 0U);
  EXPECT_NEAR(r.loop.guard().delivered_j(), r.dev.work().renewed_j, 1e-12);
}

// A device that is where it is put, and keeps what it is told.
struct placed_device {
  using policy_tag = device_tag;
  pose T_dh{};
  device_command commanded{};
  device_capabilities stated = simulated_settings{}.capabilities;

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
    commanded = out;
    return status::ok;
  }
};

// A tick that comes late moves the probe by longest_step_ns at most: the hand's way since then is no leap of the probe.
TEST(gap, of_a_late_tick_is_a_tick_of_the_longest_step) {
  const auto after = [](std::int64_t silence_ns) {
    placed_device dev;
    exchange shared;
    std::vector<session_record> log;
    control_settings control;
    control.longest_step_ns = 5 * ms;
    device_loop<placed_device, test_support::keep_all> loop(dev, control, vec3(0.0), shared,
                                                            test_support::keep_all{&log});
    EXPECT_EQ(loop.tick(0), status::ok);
    dev.T_dh.position = {0.0, 0.01, 0.0};
    EXPECT_EQ(loop.tick(silence_ns), status::ok);
    EXPECT_EQ(dev.commanded.on_hand.force, log.back().on_hand_d.force);
    EXPECT_EQ(dev.commanded.valid_until_ns, silence_ns + 20 * ms);
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

TEST(gap, of_an_expired_command_is_silent_unbooked_and_ends_in_a_ramp) {
  wall_rig r(pressing());
  r.run(0, 400);
  const double before_n = r.force_n();
  const double booked_j = r.loop.guard().delivered_j();
  ASSERT_GT(before_n, 1.0);
  r.tick(450 * ms);
  EXPECT_EQ(r.force_n(), 0.0);
  EXPECT_EQ(r.loop.guard().delivered_j(), booked_j);
  EXPECT_EQ(r.loop.gate().fault(), gate_fault::none);
  double last_n = 0.0;
  for (std::int64_t t = 451; t < 700; ++t) {
    r.tick(t * ms);
    ASSERT_LE(r.force_n() - last_n, 2.0 + 1e-9) << t;  // 2000 N/s over 1 ms
    ASSERT_TRUE(t >= 500 || r.force_n() == 0.0) << t;
    last_n = r.force_n();
  }
  EXPECT_GT(last_n, 0.3);
  EXPECT_NEAR(r.loop.guard().delivered_j(), r.dev.work().renewed_j, 1e-12);
}

TEST(gap, that_is_too_long_shuts_the_gate) {
  device_capabilities slow = strong();
  slow.force_slew_n_per_s = 100.0;
  wall_rig r(pressing(), slow);
  r.run(0, 450);
  ASSERT_GT(r.force_n(), 1.0);
  const double booked_j = r.loop.guard().delivered_j();
  for (std::int64_t t = 950; t < 1400; ++t) {
    r.tick(t * ms);
    ASSERT_EQ(r.force_n(), 0.0) << t;
  }
  EXPECT_EQ(r.loop.gate().fault(), gate_fault::stalled);
  EXPECT_EQ(r.loop.guard().delivered_j(), booked_j);
  EXPECT_FALSE(may_put_out(r.dev.state()));
}

// Without a watchdog the device held its wrench all the time: that work was done.
TEST(gap, of_a_device_without_a_watchdog_is_booked) {
  device_capabilities keeps = strong();
  keeps.device_side_watchdog = false;
  const hand_script hand = pressing();
  wall_rig r(hand, keeps);
  r.run(0, 400);
  const vec3 held_n = r.dev.motors().back().out.force;
  const double booked_j = r.loop.guard().delivered_j();
  const vec3 way = hand.at(450 * ms).position - hand.at(399 * ms).position;
  r.tick(450 * ms);
  ASSERT_GT(std::fabs(glm::dot(held_n, way)), 1e-4);
  EXPECT_NEAR(r.loop.guard().delivered_j() - booked_j, glm::dot(held_n, way), 1e-12);
}

// The hand enters the wall while the contact thread stands still for less than a lapse: the probe sinks in with it. The
// contact that comes then throws the probe out, and the hand must not feel that.
TEST(gap, of_contacts_at_a_touch_is_not_felt_as_a_blow) {
  const hand_script hand{.above_m = 0.002, .depth_m = 0.003, .press_hz = 1.5, .scrub_m = 0.0, .turn_rad = 0.0};
  for (const std::int64_t gap_ms : {10, 30, 60, 95}) {
    test_support::analytic_wall stiff;
    stiff.stiffness_n_per_m = 5000.0;
    wall_rig r(hand, strong(), {}, stiff);
    double most_n = 0.0;
    for (std::int64_t t = 0; t < 600; ++t) {
      // The surface is touched after 145 ms; 1.4 N are felt at the deepest point, after 333 ms.
      if (t < 140 || t >= 140 + gap_ms) static_cast<void>(r.contact.tick(t * ms));
      static_cast<void>(r.loop.tick(t * ms));
      most_n = std::max(most_n, r.force_n());
    }
    EXPECT_LT(most_n, 1.7) << gap_ms;
    EXPECT_EQ(r.loop.rates().report().surprises, gap_ms > 25 ? 1U : 0U) << gap_ms;
    EXPECT_EQ(r.loop.gate().fault(), gate_fault::none);
  }
}

// A plate 4 mm thick, felt from whichever side is nearer.
struct thin_plate {
  std::array<contact, 1> contacts{};
  std::array<penetration, 1> depths{};
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    const double z = at.T_wa.position.z;
    const bool above = z > -0.002;
    const double depth = above ? -z : z + 0.004;
    contacts[0] = {};
    contacts[0].window.n_ab_w = {0.0, 0.0, above ? -1.0 : 1.0};
    depths[0] = {};
    depths[0].depth_m = depth;
    if (depth > 0.0) {
      const vec6 g{contacts[0].window.n_ab_w, vec3(0.0)};
      out.force.on_probe_w = to_wrench(-6000.0 * depth * g);
      add_outer(out.force.stiffness, -6000.0, g);
    }
    out.centre_of_mass_w = at.T_wa.position;
    out.contacts = contacts;
    out.depths = depths;
    return status::ok;
  }
};

// The hand goes from above the plate to below it within a gap. The probe comes after, slowly enough for contacts to
// see the plate, and stays above it, where it stays without a gap.
TEST(gap, does_not_carry_the_probe_through_a_plate) {
  const hand_script hand{.above_m = 0.004, .depth_m = 0.007, .press_hz = 3.0, .scrub_m = 0.0, .turn_rad = 0.0};
  for (const bool stalled : {false, true}) {
    for (std::int64_t from_ms = 20; from_ms < 90; from_ms += 10) {
      rig<thin_plate> r(hand, strong());
      r.run(0, from_ms);
      r.run(stalled ? from_ms + 60 : from_ms, 167);
      EXPECT_GT(r.loop.probe().state().T_wc.position.z, -0.002) << from_ms << (stalled ? " stalled" : "");
    }
  }
}

// The same of a turn: the hand turns by half a radian in the gap, and the probe comes after slowly.
TEST(gap, does_not_whirl_the_probe_round) {
  const hand_script hand{.above_m = 0.5, .depth_m = -0.5, .scrub_m = 0.0, .turn_rad = 0.8, .turn_hz = 0.5};
  wall_rig r(hand);
  r.run(0, 700);
  ASSERT_GT(std::fabs(hand.angle_rad(940 * ms) - hand.angle_rad(699 * ms)), 0.45);
  double most_rad_per_s = 0.0;
  for (std::int64_t t = 940; t < 1000; ++t) {
    r.tick(t * ms);
    most_rad_per_s = std::max(most_rad_per_s, glm::length(r.loop.probe().state().velocity_w.angular));
  }
  EXPECT_LT(most_rad_per_s, 5.0);
  EXPECT_GT(most_rad_per_s, 1.0) << "the probe did not come after the hand";
}

// Whoever has seen the fault and clears it begins anew: the probe is placed at the hand, and lateness is over.
TEST(gap, is_forgotten_with_the_fault) {
  wall_rig r(pressing());
  r.run(0, 1150);
  r.tick(1450 * ms);
  ASSERT_EQ(r.loop.gate().fault(), gate_fault::stalled);
  EXPECT_EQ(r.loop.tick(1451 * ms), status::gate_shut);
  ASSERT_TRUE(r.loop.clear_fault());
  ASSERT_TRUE(r.dev.arm());
  r.run(1452, 1480);
  EXPECT_GT(r.force_n(), 0.5);
}

// In free space the coupling drags the probe along, and no more than that may be felt when ticks come late.
TEST(gap, does_not_add_to_the_drag_of_a_free_probe) {
  const auto most_n = [](std::int64_t gap_ms) {
    const hand_script free{.above_m = 0.5, .depth_m = -0.5, .scrub_m = 0.05, .scrub_hz = 1.5, .turn_rad = 0.0};
    control_settings control;
    control.rates.fading_lost_share = 2.0;  // judged by itself, without what lateness takes away
    control.rates.silent_lost_share = 3.0;
    wall_rig r(free, strong(), control);
    double most = 0.0;
    for (std::int64_t t = 0; t < 2000; t += t < 500 ? 1 : gap_ms) {
      r.tick(t * ms);
      if (t > 600) most = std::max(most, r.force_n());
    }
    return most;
  };
  const double punctual_n = most_n(1);
  for (const std::int64_t gap_ms : {2, 5, 10, 19}) {
    // A probe of 10 g at 0.05 m, 1.5 Hz needs 0.044 N; the spring turns a later step into a little more.
    EXPECT_LT(most_n(gap_ms), 1.3 * punctual_n + 0.02) << gap_ms << " ms, punctual " << punctual_n << " N";
  }
}

TEST(gap, counts_as_silence_of_the_application) {
  control_settings control;
  control.watchdog_ns = 1000 * ms;
  control.rates.longest_gap_ns = 10'000 * ms;  // so that the watchdog has to see it
  control.rates.longest_contact_age_ns = 10'000 * ms;
  control.rates.longest_silence_ns = 10'000 * ms;
  wall_rig r(pressing(), strong(), control);
  for (std::int64_t t = 0; t < 400; ++t) {
    r.shared.application.beat();
    r.tick(t * ms);
  }
  r.shared.application.beat();  // the whole process stood still: it beats again just before the loop ticks again
  r.tick(2400 * ms);
  EXPECT_EQ(r.loop.gate().fault(), gate_fault::watchdog);
}

// The device let go of an expired command, so the next one begins at nothing.
TEST(gap, lets_the_gate_begin_at_zero) {
  for (const std::int64_t gap_ms : {20, 21, 500}) {
    output_gate gate({.peak_force_n = 10.0,
                      .continuous_force_n = 10.0,
                      .force_slew_n_per_s = 100.0,
                      .peak_torque_n_m = 1.0,
                      .continuous_torque_n_m = 1.0,
                      .torque_slew_n_m_per_s = 100.0});
    device_command out;
    const wrench wanted{{10.0, 0.0, 0.0}, vec3(0.0)};
    for (std::int64_t t = 0; t <= 200; ++t) {
      out = gate.pass(t * ms, {}, {wanted, wrench_frame::device_base, t * ms, 0});
    }
    ASSERT_NEAR(out.on_hand.force.x, 10.0, 1e-9);
    const std::int64_t t = 200 + gap_ms;
    out = gate.pass(t * ms, {}, {wanted, wrench_frame::device_base, t * ms, 0});
    EXPECT_NEAR(out.on_hand.force.x, gap_ms > 20 ? 0.4 : 10.0, 1e-9) << gap_ms;  // 100 N/s over 4 ms
  }
}

// The motors are warm from what they held, however late the next tick comes.
TEST(gap, does_not_let_the_motors_grow_hotter_than_allowed) {
  for (const std::int64_t gap_ms : {1, 7, 19, 40}) {
    output_gate gate({.peak_force_n = 10.0,
                      .continuous_force_n = 3.0,
                      .force_slew_n_per_s = 1e6,
                      .peak_torque_n_m = 1.0,
                      .continuous_torque_n_m = 0.2,
                      .torque_slew_n_m_per_s = 1e6,
                      .thermal_time_s = 2.0});
    double force_square = 0.0;  // of what the motors do, by small steps
    double torque_square = 0.0;
    double most = 0.0;
    for (std::int64_t t = 0; t < 20'000; t += gap_ms) {
      const wrench wanted{{10.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
      const device_command out = gate.pass(t * ms, {}, {wanted, wrench_frame::device_base, t * ms, 0});
      for (std::int64_t i = 0; i < gap_ms; ++i) {
        const bool valid = (t + i) * ms < out.valid_until_ns;
        const double f = valid ? out.on_hand.force.x : 0.0;
        const double m = valid ? out.on_hand.torque.y : 0.0;
        force_square += 1e-3 / 2.0 * (f * f - force_square);
        torque_square += 1e-3 / 2.0 * (m * m - torque_square);
        most = std::max({most, force_square / 9.0, torque_square / 0.04});
      }
    }
    EXPECT_LE(most, 1.03) << gap_ms << " ms";
    EXPECT_GT(most, 0.9) << gap_ms << " ms: the limit was never reached, so this showed nothing";
  }
}

}  // namespace gap_test
