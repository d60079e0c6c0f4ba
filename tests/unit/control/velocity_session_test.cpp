// What a session makes of a handle's velocity: how an encoder's steps come through, and that no hand receives energy.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <optional>

#include <asperity/control/vibration_monitor.hpp>
#include <asperity/planes/plane_renderer.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr std::array sources{velocity_source::poses, velocity_source::window, velocity_source::device};

/// Noise of the force on the hand above 60 Hz, N rms, of a hand that presses or rubs slowly on a flat face.
double noise_n(velocity_source source, double step_m, bool moves, std::uint64_t seed) {
  struct watch {
    vec3 force_n{0.0};
    velocity_source used = velocity_source::poses;
    void operator()(const session_record& r) noexcept {
      force_n = r.on_hand_d.force;
      used = r.velocity;
    }
  };
  simulated_settings hand = hand_that_presses(5.0, {0, 0, 0.01}, {0, 0, -1}, 1500.0);
  hand.seed = seed;
  hand.hand.tremor_m = 2e-5;
  hand.measurement.position_resolution_m = hand.capabilities.position_resolution_m = step_m;
  if (moves) {
    hand.motion.kind = motion_kind::scrub;
    hand.motion.amplitude_m = 0.01;
    hand.motion.frequency_hz = 0.25;
  }
  control_settings control;
  control.coupling = coupling_for(simulated_capabilities(), 1000.0);
  control.velocity = source;
  simulated_device dev(hand);
  EXPECT_TRUE(dev.open() && dev.arm());
  virtual_session<plane_body, simulated_device, watch> session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control,
                                                               {.contact_one_period_late = true});
  detail::high_pass_4<3> high(60.0, 1000.0);
  double sum = 0.0;
  int n = 0;
  for (int i = 0; i < 2500; ++i) {
    static_cast<void>(session.step());
    const vec3& f = session.device().observer().force_n;
    const auto [x, y, z] = high({f.x, f.y, f.z});
    if (i < 1000) continue;
    sum += x * x + y * y + z * z;
    ++n;
  }
  EXPECT_EQ(session.device().observer().used, source);
  return std::sqrt(sum / n);
}

TEST(velocity_session, an_encoders_steps_come_through_less) {
  const std::uint64_t seed = fresh_seed("velocity_session", "12 sessions");
  std::printf("| encoder | velocity | at rest | moving by 16 mm/s |\n|---|---|---|---|\n");
  for (const double step_m : {1e-5, 1e-6}) {
    std::array<double, 3> rest{}, moving{};
    for (std::size_t i = 0; i < sources.size(); ++i) {
      rest[i] = noise_n(sources[i], step_m, false, seed_of(seed, "rest"));
      moving[i] = noise_n(sources[i], step_m, true, seed_of(seed, "moving"));
      std::printf("| %.0f um | %s | %.2f mN | %.2f mN |\n", 1e6 * step_m, to_string(sources[i]), 1e3 * rest[i],
                  1e3 * moving[i]);
    }
    EXPECT_LT(rest[1], 0.5 * rest[0]) << step_m;
    EXPECT_LT(rest[2], 0.5 * rest[0]) << step_m;
    EXPECT_LT(moving[1], 0.5 * moving[0]) << step_m;
    EXPECT_LT(moving[2], 0.5 * moving[0]) << step_m;
  }
}

TEST(velocity_session, makes_no_energy) {
  drawn d(seed_of(fresh_seed("velocity_session_energy", "36 sessions, 360 at length"), "hands"));
  const int each = extent(1, 10);
  for (const std::int64_t device_ns : {5'000'000, 1'000'000, 250'000, 100'000}) {
    for (const velocity_source source : sources) {
      double surplus_j = 0.0, deepest_m = 0.0;
      for (int i = 0; i < each * hand_kinds; ++i) {
        plane_case c;
        c.body = block_on_plate(i % 2 == 0 ? 0.001 : 0.02);
        c.body.reported_gap_m = reach_for(1e-3, 1e-9 * static_cast<double>(device_ns));
        c.control.guard.enabled = false;
        c.control.velocity = source;
        c.control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(device_ns));
        c.schedule = {.device_period_ns = device_ns, .contact_period_ns = 1'000'000, .contact_one_period_late = true};
        c.length_s = 0.7;
        draw_hand(c.hand, i % hand_kinds, d);
        const plane_outcome o = run(c);
        EXPECT_EQ(o.not_ok, 0U);
        EXPECT_LE(o.surplus_j, 1e-5) << to_string(source) << ' ' << device_ns << " hand " << i % hand_kinds;
        EXPECT_LT(o.deepest_m, 4e-4) << to_string(source) << ' ' << device_ns << " hand " << i % hand_kinds;
        surplus_j = std::max(surplus_j, o.surplus_j);
        deepest_m = std::max(deepest_m, o.deepest_m);
      }
      std::printf("| %.0f Hz | %s | %.4f mJ | %.3f mm |\n", 1e9 / static_cast<double>(device_ns), to_string(source),
                  1e3 * surplus_j, 1e3 * deepest_m);
    }
  }
}

/// A simulated device whose samples somebody spoils.
struct lying_device : simulated_device {
  using simulated_device::simulated_device;
  double factor = 1.0;
  sample_field leaves_out = sample_field::none;
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    const status s = simulated_device::read(now_ns, in);
    in.velocity_d = {factor * in.velocity_d.linear, factor * in.velocity_d.angular};
    in.valid = static_cast<sample_field>(static_cast<unsigned>(in.valid) & ~static_cast<unsigned>(leaves_out));
    return s;
  }
};

struct keep_worst {
  double fastest_change_n = 0.0;
  std::optional<vec3> before{};
  session_record last{};
  void operator()(const session_record& r) noexcept {
    if (before) fastest_change_n = std::max(fastest_change_n, glm::length(r.on_hand_d.force - *before));
    before = r.on_hand_d.force;
    last = r;
  }
};

/// A hand that wanders in free space with a device that lies. @return what its last tick told, and the worst before
keep_worst wander(double factor, sample_field leaves_out) {
  simulated_settings hand;
  hand.motion.kind = motion_kind::free;
  hand.motion.amplitude_m = 0.05;
  hand.motion.T_dh.position.z = 0.5;
  control_settings control;
  control.velocity = velocity_source::device;
  control.coupling = coupling_for(simulated_capabilities(), 1000.0);
  lying_device dev(hand);
  dev.factor = factor;
  dev.leaves_out = leaves_out;
  EXPECT_TRUE(dev.open() && dev.arm());
  virtual_session<plane_body, lying_device, keep_worst> session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev, control);
  for (int i = 0; i < 4000; ++i) static_cast<void>(session.step());
  EXPECT_EQ(session.device().gate().fault(), gate_fault::none) << factor;
  return session.device().observer();
}

TEST(velocity_session, a_device_that_lies_is_told_and_does_not_push) {
  const double truth_n = wander(1.0, sample_field::none).fastest_change_n;
  for (const double factor : {-1.0, 0.0, 3.0, std::nan("")}) {
    const keep_worst seen = wander(factor, sample_field::none);
    EXPECT_TRUE(seen.last.velocity_refused) << factor;
    EXPECT_EQ(seen.last.velocity, velocity_source::window) << factor;
    EXPECT_LT(seen.fastest_change_n, truth_n + 2.5) << factor;  // once, where the window takes over
  }
  const keep_worst none = wander(1.0, sample_field::linear_velocity | sample_field::angular_velocity);
  EXPECT_EQ(none.last.velocity, velocity_source::window);
  EXPECT_FALSE(none.last.velocity_refused);
}

// The handle turns about itself, 60 mm off the probe's centre: the target moves, and the damper has to know.
TEST(velocity_session, knows_the_lever_from_handle_to_probe) {
  control_settings control;
  control.map = {{exp_rotation({0.3, 0.2, 0.1}), {0.1, 0, 0.5}}, 2.0, {quat(1, 0, 0, 0), {0.06, 0, 0}}};
  simulated_settings hand;
  hand.motion.kind = motion_kind::twist;
  hand.motion.direction_d = {0, 0, 1};
  hand.motion.depth_m = 0.0;
  hand.motion.amplitude_rad = 0.5;
  const auto lag_m = [&](velocity_source source) {
    control.velocity = source;
    simulated_device dev(hand);
    EXPECT_TRUE(dev.open() && dev.arm());
    virtual_session<plane_body, simulated_device, keep_worst> session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev,
                                                                      control);
    double worst = 0.0;
    for (int i = 0; i < 2000; ++i) {
      static_cast<void>(session.step());
      const session_record& r = session.device().observer().last;
      worst = std::max(worst, glm::length(r.T_wa.position - r.T_wa_target.position));
    }
    return worst;
  };
  const double by_poses = lag_m(velocity_source::poses);
  EXPECT_NEAR(lag_m(velocity_source::device), by_poses, 0.3 * by_poses);
  EXPECT_NEAR(lag_m(velocity_source::window), by_poses, 0.5 * by_poses);
}

}  // namespace
