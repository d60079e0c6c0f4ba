// How far a tick says that the probe may move: nothing is met on the way that no plane stands for, and a hand in free
// space is not held back by it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <utility>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/control/drawn.hpp"
#include "unit/planes/scene_with_fields.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr double relief_m = 60e-6;
const vec3 probe_half(0.012, 0.01, 0.008), fixed_half(0.03, 0.03, 0.01);

const scene_with_fields& ridged() {
  static const scene_with_fields made = [] {
    const auto probe =
        std::make_shared<const textured_model>(make_textured_box(probe_half, 256, ridges(relief_m, 2e-3)));
    const auto fixed =
        std::make_shared<const textured_model>(make_textured_box(fixed_half, 384, ridges(relief_m, 3e-3)));
    return with_fields({probe, {fixed}});
  }();
  return made;
}

plane_renderer make_ridged(double reach_m) {
  return make_plane_renderer(ridged().of, ridged().fields, {.reach_m = reach_m}).value();
}

/// The deepest of a tick's planes at a pose that the probe has moved to; 0 where there is none that is met.
double told_m(const tick& t, const vec6& moved) {
  double out = 0.0;
  for (const support_plane& p : t.planes) out = std::max(out, p.depth_m + dot(p.gradient, moved));
  return out;
}

pose moved_by(const pose& T_wa, const vec3& c_a_w, const vec6& by) {
  const quat turn = exp_rotation(by.angular);
  return {glm::normalize(turn * T_wa.rotation), c_a_w + by.linear + turn * (T_wa.position - c_a_w)};
}

/// Draws motions as far as ticks say, and more, and asks at their ends what is met.
/// @return how much deeper than told the worst is, m
double met_untold_m(drawn& d, double times_as_far, int poses) {
  const std::vector<pose> T_wb{pose{}};
  plane_renderer feel = make_ridged(1.8e-3), there = make_ridged(1.8e-3);
  double worst_m = 0.0;
  int met = 0;
  tick t, after;
  for (int i = 0; i < poses; ++i) {
    // Above the plate, beside it, or a few centimetres away.
    const quat turn = exp_rotation(3.0 * d.direction() * d.between(0.0, 1.0));
    pose T_wa{turn, {d.between(-0.035, 0.035), d.between(-0.035, 0.035), 0.06}};
    const double stops_m = i % 3 == 0 ? d.log_between(1e-4, 0.02) : d.between(0.0, 2e-3);
    for (int k = 0; k < 60; ++k) {
      EXPECT_EQ(feel.step({T_wa, T_wb}, t), status::ok);
      double gap_m = t.known.way_m;
      for (const support_plane& p : t.planes) gap_m = std::min(gap_m, -p.depth_m);
      if (!(gap_m > stops_m + 1e-5) || T_wa.position.z < -0.02) break;
      T_wa.position.z -= gap_m - stops_m;
    }
    EXPECT_GE(t.known.way_m, 1.8e-3);
    // The probe has depth 0.02 m at most, so each of 20 motions may meet something.
    for (int k = 0; k < 20; ++k) {
      const double turned = d.between(0.0, 1.0);
      vec3 way = d.direction();
      if (way.z > 0.0) way.z = -way.z;
      const vec6 by{times_as_far * (1.0 - turned) * t.known.way_m * way,
                    times_as_far * turned * t.known.turn_rad * d.direction()};
      if (glm::length(by.angular) > 0.3) continue;  // planes are of the first order
      EXPECT_EQ(there.step({moved_by(T_wa, t.centre_of_mass_w, by), T_wb}, after), status::ok);
      const double now_m = told_m(after, {});
      met += now_m > 0.0 ? 1 : 0;
      worst_m = std::max(worst_m, now_m - told_m(t, by));
    }
  }
  EXPECT_GT(met, poses / 2);
  return worst_m;
}

// What is met and was not told is the relief that lies beside the path, and what the turn of a plane bends.
TEST(known_motion, meets_nothing_that_no_plane_stands_for) {
  drawn d(seed_of(fresh_seed("known_motion", "40 poses, 400 at length"), "motions"));
  const int poses = extent(40, 400);
  const double within_m = met_untold_m(d, 1.0, poses), further_m = met_untold_m(d, 3.0, poses);
  std::printf("  met untold: %.3f mm, three times as far %.3f mm\n", 1e3 * within_m, 1e3 * further_m);
  // The largest of 8,000 motions was 4.02 reliefs on one day's seed; the control is fifty times as far.
  EXPECT_LT(within_m, 5.0 * relief_m);
  EXPECT_GT(further_m, 5.0 * relief_m) << "the control: motions that go three times as far meet nothing either";
}

// A loop asks for less than the whole reach: what is told, and how far the probe may go, end there.
TEST(known_motion, ends_with_the_gaps_that_are_wanted) {
  drawn d(seed_of(fresh_seed("known_motion, gaps", "60 poses"), "gaps"));
  const std::vector<pose> T_wb{pose{}};
  plane_renderer feel = make_ridged(1.8e-3);
  std::size_t planes = 0;
  tick t;
  for (int i = 0; i < 60; ++i) {
    const double gaps_m = d.between(0.4e-3, 3e-3), told_m = std::min(gaps_m, 1.8e-3);
    const double height_m = fixed_half.z + probe_half.z + d.between(0.0, 0.5) * told_m;
    ASSERT_EQ(feel.step({{quat(1.0, 0.0, 0.0, 0.0), {d.between(-0.01, 0.01), 0.0, height_m}}, T_wb, gaps_m}, t),
              status::ok);
    EXPECT_EQ(t.known.way_m, told_m);
    for (const support_plane& p : t.planes) EXPECT_GT(p.depth_m, -told_m);
    planes += t.planes.size();
    // The next contact is asked for what this one was used for, and half as much again.
    linear_contact used;
    used.known = t.known;
    EXPECT_NEAR(gaps_for(used, {quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, told_m)}, 5e-4), 5e-4 + 1.5 * told_m, 1e-12);
  }
  EXPECT_GT(planes, 60U);
  EXPECT_TRUE(std::isinf(gaps_for({}, {}, 5e-4)));
}

struct without_border {
  plane_renderer feel;
  bool free = false;
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const status s = feel.step(at, out);
    if (free) out.known = {};
    return s;
  }
};

struct passing {
  double fastest_m_per_s = 0.0;
  double more_lag_m = 0.0;    ///< than without a border
  double more_force_n = 0.0;  ///< on the hand
  double raised_m = 0.0;      // without a border, by planes
};

/// A handle that swings sideways over the plate at a height, nearly as its script says.
passing swing(double height_m, double speed_m_per_s, std::int64_t device_ns, std::int64_t contact_ns,
              bool reads_again = true) {
  struct watch {
    std::vector<session_record> seen;
    void operator()(const session_record& r) noexcept { seen.push_back(r); }
  };
  constexpr double amplitude_m = 0.04;
  simulated_settings made;
  made.hand = {.stiffness_n_per_m = 3000, .damping_n_s_per_m = 40, .tremor_m = 0};
  made.capabilities.workspace_low_d = vec3(-1.0);
  made.capabilities.workspace_high_d = vec3(1.0);
  motion_settings& m = made.motion;
  m.kind = motion_kind::scrub;
  m.direction_d = {0.0, 0.0, -1.0};
  m.sideways_d = {1.0, 0.0, 0.0};
  m.depth_m = 0.0;
  m.approach_s = 0.05;
  m.amplitude_m = amplitude_m;
  m.frequency_hz = speed_m_per_s / (6.283185307179586 * amplitude_m);
  m.T_dh.position = {0.0, 0.0, fixed_half.z + probe_half.z + relief_m + height_m};
  control_settings control;
  control.local_model = reads_again;
  control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(device_ns));
  const vec3 c_a = ridged().of.probe->mass.centre_of_mass;
  control.map.T_ha = {quat(1.0, 0.0, 0.0, 0.0), -c_a};
  const auto run = [&](bool free) {
    simulated_device dev(made);
    EXPECT_TRUE(dev.open() && dev.arm());
    const double reach_m = reach_for(1e-9 * static_cast<double>(contact_ns), 1e-9 * static_cast<double>(device_ns));
    virtual_session<without_border, simulated_device, watch> session(
        {make_ridged(reach_m), free}, {{pose{}}, c_a}, dev, control,
        {.device_period_ns = device_ns, .contact_period_ns = contact_ns, .contact_one_period_late = true});
    static_cast<void>(session.run_until(static_cast<std::int64_t>(1e9 * (0.6 + 1.5 / m.frequency_hz))));
    return std::move(session.device().observer().seen);
  };
  const std::vector<session_record> held = run(false), open = run(true);
  passing out;
  for (std::size_t i = 1; i < held.size(); ++i) {
    const auto lag_m = [](const session_record& r) { return glm::distance(r.T_wa.position, r.T_wa_target.position); };
    out.more_lag_m = std::max(out.more_lag_m, lag_m(held[i]) - lag_m(open[i]));
    out.raised_m = std::max(out.raised_m, open[i].T_wa.position.z - open[i].T_wa_target.position.z);
    out.more_force_n = std::max(out.more_force_n, glm::distance(held[i].on_hand_d.force, open[i].on_hand_d.force));
    out.fastest_m_per_s =
        std::max(out.fastest_m_per_s, glm::distance(open[i].T_wa_target.position, open[i - 1].T_wa_target.position) /
                                          (1e-9 * static_cast<double>(device_ns)));
  }
  return out;
}

// Far from bodies a hand of 1 m/s is not held back, nor close by one of the speed that the reach is meant for. Closer
// than three reaches a faster hand waits for what it cannot know.
TEST(known_motion, does_not_hold_a_hand_in_free_space) {
  constexpr double least_felt_n = 0.02;
  struct rates {
    std::int64_t device_ns, contact_ns;
  };
  double held_n = 0.0;
  std::printf("| height | device, contacts | fastest | lags by | is pulled by |\n|---|---|---|---|---|\n");
  for (const double height_m : {0.03, 0.01, 0.005, 0.001}) {
    for (const rates& r : {rates{1'000'000, 1'000'000}, {1'000'000, 5'000'000}, {250'000, 250'000}}) {
      for (const double speed : {0.3, 0.55, 1.0, 2.0}) {
        // A share: two that must not be held, and the fastest at a millimetre, which must.
        const bool of_share = r.device_ns == 1'000'000 && r.contact_ns == 1'000'000 &&
                              (height_m < 0.002 ? speed == 0.55 || speed == 2.0 : speed == 1.0 && height_m > 0.02);
        if (!at_length() && !of_share) continue;
        const passing o = swing(height_m, speed, r.device_ns, r.contact_ns);
        std::printf("| %.0f mm | %.0f Hz, %.0f Hz | %.2f m/s | %.3f mm | %.1f mN |\n", 1e3 * height_m,
                    1e9 / static_cast<double>(r.device_ns), 1e9 / static_cast<double>(r.contact_ns), o.fastest_m_per_s,
                    1e3 * o.more_lag_m, 1e3 * o.more_force_n);
        const bool free = (height_m > 0.02 && speed <= 1.0) || speed < 0.6;
        if (free) {
          EXPECT_LT(o.raised_m, 1e-4) << height_m << ' ' << speed;
          EXPECT_LT(o.more_force_n, least_felt_n) << height_m << ' ' << speed;
        }
        held_n = std::max(held_n, o.more_force_n);
      }
    }
  }
  // Planes are straight. With contacts of 200 Hz, a hand sweeps past ridges further than a plane of their flanks is true,
  // and is raised by it, unless the device loop reads it again.
  EXPECT_GT(swing(0.001, 0.3, 1'000'000, 5'000'000, false).raised_m, 1e-4) << "the control: planes that stay";
  EXPECT_GT(held_n, 1.0) << "the control: a hand of 2 m/s a millimetre over a body is not held either";
}

}  // namespace
}  // namespace asperity
