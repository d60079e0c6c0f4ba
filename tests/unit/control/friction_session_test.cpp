// Whole sessions with friction: what the hand feels, how deep the probe is, and that friction gives no energy.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

#include <asperity/control/virtual_coupling.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double most_surplus_j = 1e-5;  // the guard's tolerance: rounding and the encoder's steps

/// A block or ball on a body of planes, in loops of these rates with contacts one period late and no guard.
plane_case rubbed(plane_body body, double mu_static, double mu_dynamic, double device_hz, double contact_hz) {
  plane_case c;
  c.body = std::move(body);
  c.control.guard.enabled = false;
  c.control.friction = {.static_coefficient = mu_static, .dynamic_coefficient = mu_dynamic};
  c.hand = hand_that_presses(10.0, {0, 0, 0.01}, {0, 0, -1}, 500.0);
  c.schedule = {.device_period_ns = static_cast<std::int64_t>(1e9 / device_hz),
                .contact_period_ns = static_cast<std::int64_t>(1e9 / contact_hz),
                .contact_one_period_late = true};
  return c;
}

// Three hands press, scrub and tap on a plate, in a corner and in a groove, as hard as they like.
TEST(friction_session, holds_and_makes_no_energy) {
  drawn d(seed_of(fresh_seed("friction_session.holds_and_makes_no_energy", "36 sessions, 864 at length"), "friction"));
  struct rates {
    double device_hz, contact_hz;
  };
  constexpr std::array<rates, 4> rubbed_rates{{{10'000, 10'000}, {4000, 1000}, {1000, 1000}, {200, 200}}};
  double deepest_fast = 0.0, deepest_slow = 0.0, surplus = 0.0;
  const int each = extent(1, 24);
  for (const rates& r : rubbed_rates) {
    for (const double mu : {0.0, 0.4, 1.0}) {
      for (int kind = 0; kind < 3; ++kind) {
        for (int n = 0; n < each; ++n) {
          const int i = static_cast<int>(d.bits() % 4);
          plane_body body = i == 0 ? block_on_plane() : block_on_plate(0.001);
          double touch = 0.01;
          if (i == 2) body = ball_in_corner(0.005), touch = 0.005;
          if (i == 3) body = ball_in_groove(0.005, 0.7), touch = 0.0062;
          plane_case c = rubbed(std::move(body), mu, mu * d.between(0.5, 1.0), r.device_hz, r.contact_hz);
          c.control.coupling = coupling_for(simulated_capabilities(), r.device_hz);
          const double part = d.log_between(0.2, 1.0);
          c.control.coupling.stiffness_n_per_m *= part;
          c.control.coupling.stiffness_n_m_per_rad *= part;
          c.hand.seed = d.bits();
          c.hand.hand = kind == 0 ? soft_hand() : (kind == 1 ? firm_hand() : hand_settings{});
          motion_settings& m = c.hand.motion;
          const double heading = d.between(0.0, 6.283), tilt = d.between(0.0, 0.5);
          m.kind = kind == 2 ? motion_kind::tap : (d.between(0.0, 1.0) < 0.3 ? motion_kind::press : motion_kind::scrub);
          m.direction_d = {std::sin(tilt) * std::cos(heading), std::sin(tilt) * std::sin(heading), -std::cos(tilt)};
          m.sideways_d = glm::normalize(glm::cross(m.direction_d, any_orthogonal(m.direction_d)));
          m.T_dh.position = i == 2 ? vec3(0.012, 0.012, 0.009) : vec3(0, 0, touch + d.between(0.002, 0.004));
          m.depth_m = d.between(0.005, 0.02);
          m.approach_s = d.between(0.1, 0.25);
          m.amplitude_m = kind == 2 ? m.depth_m + d.between(0.0, 0.01) : d.between(0.002, 0.01);
          m.frequency_hz = kind == 2 ? d.between(3.0, 6.0) : d.between(0.5, 4.0);
          const plane_outcome o = run(c);
          const auto which = [&]() {
            return "mu " + std::to_string(mu) + " device " + std::to_string(r.device_hz) + " contact " +
                   std::to_string(r.contact_hz) + " hand " + std::to_string(kind) + " body " + std::to_string(i);
          };
          EXPECT_EQ(o.not_ok, 0U) << which();
          EXPECT_LE(o.unbalanced_n, 1e-7) << which();
          EXPECT_LE(o.surplus_j, most_surplus_j) << which();
          double& deepest = r.contact_hz < 500.0 ? deepest_slow : deepest_fast;
          deepest = std::max(deepest, o.deepest_m);
          surplus = std::max(surplus, o.surplus_j);
        }
      }
    }
  }
  std::printf("  deepest %.3f mm, %.3f mm at 200 Hz; most energy %.5f mJ\n", 1e3 * deepest_fast, 1e3 * deepest_slow,
              1e3 * surplus);
  EXPECT_LE(deepest_fast, 1e-4);
  EXPECT_LE(deepest_slow, 3e-4);
}

// A hand that scrubs feels mu N against its motion. Without friction it feels nothing sideways.
TEST(friction_session, is_felt_as_a_share_of_what_presses) {
  drawn d(seed_of(fresh_seed("friction_session.is_felt_as_a_share_of_what_presses", "12 sessions"), "share"));
  for (int i = 0; i < 12; ++i) {
    const double mu = i % 4 == 0 ? 0.0 : d.between(0.1, 0.8);
    plane_case c = rubbed(block_on_plane(), mu, mu, i % 2 == 0 ? 1000 : 4000, 1000);
    c.hand.hand = firm_hand();
    c.hand.hand.tremor_m = 0.0;
    motion_settings& m = c.hand.motion;
    m.kind = motion_kind::scrub;
    m.depth_m = 0.002 + d.between(0.005, 0.015);
    m.amplitude_m = 0.02;
    m.frequency_hz = 0.2;  // one way until 1.55 s
    // The probe sticks until the hand has gone mu times as far sideways as it presses down: 12 mm at most, by 0.82 s.
    c.settled_s = 1.0;
    c.length_s = 1.3;
    const plane_outcome o = run(c);
    const double share = std::hypot(o.force_n.x, o.force_n.y) / o.force_n.z;
    EXPECT_GT(o.force_n.z, 1.0);
    EXPECT_NEAR(share, mu, 0.002) << i;
  }
}

// A probe that is pressed and pulled sideways within the cone stays where it is.
TEST(friction_session, sticks_where_it_is_pressed) {
  for (const bool rubs : {true, false}) {
    plane_case c = rubbed(block_on_plane(), rubs ? 0.6 : 0.0, rubs ? 0.6 : 0.0, 1000, 1000);
    c.hand.hand = firm_hand();
    c.hand.hand.tremor_m = 0.0;
    c.hand.motion.direction_d = glm::normalize(vec3(0.4, 0.0, -1.0));
    c.hand.motion.T_dh.position = vec3(0, 0, 0.01) - 0.002 * c.hand.motion.direction_d;
    c.length_s = 2.0;
    const plane_outcome soon = run(c);
    c.length_s = 4.0;
    const plane_outcome late = run(c);
    const double crept_m = glm::length(late.T_wa.position - soon.T_wa.position);
    if (rubs) {
      EXPECT_LT(crept_m, 1e-6);
      EXPECT_GT(late.force_n.x / -late.force_n.z, -0.6);
      EXPECT_GT(std::fabs(late.force_n.x), 0.1 * late.force_n.z);
    } else {
      EXPECT_LT(std::fabs(late.force_n.x), 0.02 * late.force_n.z);
    }
  }
}

}  // namespace
