// The probe's way through one device period: what an encoder's steps become in the coupling's damper.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <vector>

#include <asperity/control/probe_motion.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double um = 1e-6;

/// What a coupling gives a hand that drifts and is read in steps of 1 um, in a corner: the largest change of the force
/// between two periods.
double largest_change_n(double rate_hz, double drift_m_per_s) {
  constexpr double resolution_m = 1 * um;
  probe_motion m({}, {}, {}, 8);
  m.place({});
  linear_contact wall;
  static_cast<void>(wall.planes.push_back({0.0, {{0, 0, 1}, {0, 0, 0}}, {0, 0, 1}, {0, 0, 0}}));
  static_cast<void>(wall.planes.push_back({0.0, {{1, 0, 0}, {0, 0, 0}}, {1, 0, 0}, {0, 0, 0}}));
  double worst = 0.0, before = 0.0;
  for (int i = 1; i <= 400; ++i) {
    const double x = drift_m_per_s * i / rate_hz;
    const pose wanted{{1, 0, 0, 0}, {resolution_m * std::round(x / resolution_m), 0, 2e-3}};
    EXPECT_EQ(m.move(1.0 / rate_hz, wanted, 1.0, wall), status::ok);
    const double felt = m.on_hand_w().force.x;
    if (i > 200) worst = std::max(worst, std::fabs(felt - before));
    before = felt;
  }
  return worst;
}

TEST(probe_motion, steps_of_an_encoder_are_no_jolts_at_any_rate) {
  drawn d(seed_of(fresh_seed("probe_motion", "4 rates, 20 speeds"), "encoder"));
  for (const double rate_hz : {1000.0, 2000.0, 4000.0, 10000.0}) {
    double worst = 0.0;
    for (int i = 0; i < 20; ++i) worst = std::max(worst, largest_change_n(rate_hz, d.between(1e-3, 3e-3)));
    std::printf("  %.0f Hz: %.1f mN\n", rate_hz, 1e3 * worst);
    // A step of 1 um in a millisecond, through 4.5 N s/m; a velocity of one period alone would be 18 mN at 4 kHz.
    EXPECT_LT(worst, 9e-3) << rate_hz;
  }
}

// At 1 kHz and below the velocity is that of the period itself: no delay is added where the hand turns round.
TEST(probe_motion, slow_loops_feel_the_velocity_of_the_period) {
  drawn d(seed_of(fresh_seed("probe_motion", "200 periods"), "periods"));
  const virtual_coupling coupling({}, probe_settings{}.mass_kg, 1e-5);
  for (const double period_s : {1e-3, 2e-3, 5e-3}) {
    probe_motion m({}, {}, {}, 8);
    m.place({});
    pose before{};
    for (int i = 0; i < 200; ++i) {
      const pose now{exp_rotation(d.inside(1e-3)), d.inside(1e-4)};
      const vec6 way = pose_difference(now, before);
      ASSERT_EQ(m.move(period_s, now, 1.0, {}), status::ok);
      const probe_state& p = m.probe().state();
      const wrench expected = -1.0 * coupling.on_probe(now, to_twist((1.0 / period_s) * way), p.T_wc, p.velocity_w);
      EXPECT_LT(glm::length(m.on_hand_w().force - expected.force), 1e-12);
      EXPECT_LT(glm::length(m.on_hand_w().torque - expected.torque), 1e-12);
      before = now;
    }
  }
}

// A probe that is put somewhere else has not moved there.
TEST(probe_motion, a_placed_probe_is_at_rest) {
  probe_motion m({}, {}, {}, 8);
  m.place({});
  for (int i = 1; i <= 8; ++i) {
    ASSERT_EQ(m.move(2.5e-4, {{1, 0, 0, 0}, {1e-4 * i, 0, 0}}, 1.0, {}), status::ok);
  }
  const pose there{{1, 0, 0, 0}, {0.1, 0, 0}};
  m.place(there);
  ASSERT_EQ(m.move(2.5e-4, there, 1.0, {}), status::ok);
  EXPECT_EQ(glm::length(m.on_hand_w().force), 0.0);
}

}  // namespace
