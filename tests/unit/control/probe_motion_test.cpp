// The probe's way through one device period: what an encoder's steps become in the coupling's damper, and what becomes of
// planes on the way.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include <asperity/control/probe_motion.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/wavy_reader.hpp"

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

// Points of a probe between fine waves, contacts a period late, and a hand that stands still: whatever the way there, the
// probe comes to rest. On planes that are read once in a period one probe in eighty goes to and fro without end, by up to
// 0.05 mm.
TEST(probe_motion, a_probe_comes_to_rest_between_waves) {
  drawn d(seed_of(fresh_seed("probe_motion.a_probe_comes_to_rest_between_waves", "400 probes"), "waves"));
  constexpr int probes = 400, periods = 400, settled = 300;
  double worst_m = 0.0;
  for (int i = 0; i < probes; ++i) {
    wavy_reader reader;
    reader.of = {.amplitude_m = d.between(1e-5, 3e-5), .wave_m = d.between(1e-4, 2.5e-4)};
    reader.points_c = lower_face(0.02, 0.02, 0.01, 6);
    for (vec3& p : reader.points_c) p += d.inside(reader.of.amplitude_m);
    const pose begin_T_wc{exp_rotation({0.0, 0.0, d.between(-0.3, 0.3)}),
                          {d.between(-1e-3, 1e-3), 0.0, 0.01 + reader.of.amplitude_m}};
    linear_contact late = contact_at(reader, begin_T_wc), next = late;
    const coupling_settings coupling{.stiffness_n_per_m = 1500.0, .stiffness_n_m_per_rad = 5.0};
    const double press_m = d.between(0.2, 3.0) / coupling.stiffness_n_per_m;
    const pose wanted_T_wc{exp_rotation(d.inside(0.01)) * begin_T_wc.rotation,
                           begin_T_wc.position + vec3(d.between(-3e-4, 3e-4), d.between(-3e-4, 3e-4), -press_m)};
    probe_motion motion({}, coupling, contact_laws{}, 8);
    motion.place(begin_T_wc);
    for (int k = 0; k < periods; ++k) {
      const pose before_T_wc = motion.probe().state().T_wc;
      late = std::exchange(next, contact_at(reader, before_T_wc));
      motion.take_contact();
      ASSERT_EQ(motion.move(1e-3, wanted_T_wc, 1.0, late), status::ok);
      const vec6 way = pose_difference(motion.probe().state().T_wc, before_T_wc);
      if (k >= settled) worst_m = std::max(worst_m, glm::length(way.linear) + 0.02 * glm::length(way.angular));
    }
  }
  std::printf("  the probe that is least at rest moves by %.3f um in a period\n", worst_m / um);
  EXPECT_LT(worst_m, 0.3 * um);
}

// Each substep costs a reading. One of a short period is no shorter than those of a millisecond.
TEST(probe_motion, reads_planes_once_in_a_substep) {
  struct expected {
    double period_s;
    int substeps, readings;
  };
  for (const expected& e : {expected{1e-2, 8, 8},
                            {1e-3, 8, 8},
                            {5e-4, 8, 4},
                            {2.5e-4, 8, 2},
                            {1e-4, 8, 1},
                            {1e-3, 1, 1},
                            {2.5e-4, 20, 5}}) {
    const wavy_reader reader;
    const linear_contact contact = contact_at(reader, {});
    probe_motion motion({}, {}, contact_laws{}, e.substeps);
    motion.place({});
    motion.take_contact();
    ASSERT_EQ(motion.move(e.period_s, {}, 1.0, contact), status::ok);
    EXPECT_EQ(reader.readings, e.readings) << e.period_s << " s, " << e.substeps;
  }
}

}  // namespace
