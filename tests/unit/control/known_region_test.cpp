// A probe goes no further than its contact knows: fast touches in slow loops do not enter, and the border of what is
// known gives no energy.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>

#include <asperity/control/contact_loop.hpp>
#include <asperity/control/device_loop.hpp>
#include <asperity/planes/plane_renderer.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double no_energy_j = 1e-5;  // the guard's tolerance: rounding and the encoder's steps
constexpr std::array<std::int64_t, 4> periods_ns{5'000'000, 2'000'000, 1'000'000, 250'000};

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// A hand that comes down and how its contacts come.
struct touch_case {
  plane_body body = block_on_plane();
  simulated_settings hand{};
  control_settings control{};
  loop_periods periods{};
  double three_late_share = 0.0;  ///< of the contacts: they take three periods instead of one
  double length_s = 0.4;
  std::int64_t last_contact_ns = std::numeric_limits<std::int64_t>::max();  ///< none is computed afterwards
  std::uint64_t seed = 1;
};

struct touch_outcome {
  double deepest_m = 0.0;
  double fastest_m_per_s = 0.0;  ///< of the handle
  double surplus_j = 0.0;        ///< most energy that the hand received beyond what it had lent
  double border_j = 0.0;         ///< work of the border on the probe
  double open_j = 0.0;           ///< of the probe's book
  double largest_share = 0.0;    ///< of the known motion, at the ends of device periods after the last contact
  double lag_m = 0.0;            ///< largest way from the probe to its target
};

touch_outcome run(const touch_case& c) {
  struct watch {
    session_record last;
    void operator()(const session_record& r) noexcept { last = r; }
  };
  simulated_device dev(c.hand);
  EXPECT_TRUE(dev.open() && dev.arm());
  exchange shared;
  contact_loop<plane_body> contact(c.body, {{pose{}}, vec3(0.0)}, shared, selection_for(c.periods.renewal_ns()));
  device_loop<simulated_device, watch> loop(dev, with_periods(c.control, c.periods), vec3(0.0), shared);
  drawn d(c.seed);
  touch_outcome out;
  double surplus_j = 0.0, before_j = 0.0;
  std::int64_t next_contact_ns = 0, free_ns = 0;
  for (std::int64_t now_ns = 0; seconds(now_ns) < c.length_s; now_ns += c.periods.device_ns) {
    for (; next_contact_ns <= now_ns; next_contact_ns += c.periods.contact_ns) {
      if (next_contact_ns < free_ns) continue;
      contact.publish();
      if (next_contact_ns > c.last_contact_ns) continue;
      EXPECT_EQ(contact.compute(next_contact_ns), status::ok);
      const bool late = next_contact_ns > 0 && d.between(0.0, 1.0) < c.three_late_share;
      free_ns = next_contact_ns + (late ? 3 : 1) * c.periods.contact_ns;
    }
    static_cast<void>(loop.tick(now_ns));
    const session_record& r = loop.observer().last;
    out.deepest_m = std::max(out.deepest_m, c.body.depth_m(r.T_wa));
    out.lag_m = std::max(out.lag_m, glm::distance(r.T_wa.position, r.T_wa_target.position));
    out.fastest_m_per_s = std::max(out.fastest_m_per_s, glm::length(dev.true_velocity_d().linear));
    const double delivered_j = dev.delivered_j();
    surplus_j = std::max(-0.1, surplus_j + delivered_j - before_j);
    before_j = delivered_j;
    out.surplus_j = std::max(out.surplus_j, surplus_j);
    if (now_ns > c.last_contact_ns + 4 * c.periods.contact_ns) {
      const linear_contact& in_use = shared.contacts.front();
      out.largest_share = std::max(out.largest_share, in_use.known.share(pose_difference(r.T_wa, in_use.T_wc)));
    }
  }
  const probe_energy& e = loop.probe().energy();
  out.border_j = e.by_border_j;
  out.open_j =
      e.by_coupling_j + e.by_contact_j + e.by_external_j + e.by_border_j - e.numerical_j - loop.probe().kinetic_j();
  return out;
}

/// An arm that moves at up to `speed` and hits the body on its way.
touch_case drawn_touch(const loop_periods& p, double speed_m_per_s, drawn& d) {
  touch_case c;
  c.periods = p;
  c.seed = d.bits();
  c.body.reported_gap_m = reach_for(seconds(p.contact_ns), seconds(p.device_ns));
  c.control.guard.enabled = false;
  c.control.coupling = coupling_for(simulated_capabilities(), 1.0 / seconds(p.device_ns));
  c.hand.seed = d.bits();
  c.hand.capabilities = strong_device(20.0);
  c.hand.hand = {.stiffness_n_per_m = 3000, .damping_n_s_per_m = 40, .tremor_m = 0};
  motion_settings& m = c.hand.motion;
  const double tilt = d.between(0.0, 0.5), heading = d.between(0.0, 6.283);
  m.kind = motion_kind::press;
  m.direction_d = {std::sin(tilt) * std::cos(heading), std::sin(tilt) * std::sin(heading), -std::cos(tilt)};
  m.sideways_d = glm::normalize(glm::cross(m.direction_d, any_orthogonal(m.direction_d)));
  // Fastest half way, where the touch is.
  const double half_m = d.between(0.01, 0.03) * std::max(1.0, speed_m_per_s);
  m.T_dh = {exp_rotation(d.inside(0.1)), vec3(0, 0, 0.0115) - half_m * m.direction_d};
  m.depth_m = half_m + d.between(0.006, 0.01);
  m.approach_s = 1.5 * 2.0 * half_m / speed_m_per_s;
  c.length_s = m.approach_s + 0.1;
  return c;
}

// What a face of a few points gives way by when 10 g and a hand hit it at up to 1.6 m/s.
constexpr double gives_way_m = 2.5e-4;

TEST(known_region, a_fast_touch_does_not_enter) {
  drawn d(seed_of(fresh_seed("known_region", "64 touches, 640 at length"), "touches"));
  int entered = 0;
  std::printf("| contacts | hand | deepest | three periods late | without a border |\n|---|---|---|---|---|\n");
  for (const std::int64_t period_ns : periods_ns) {
    for (const double speed : {0.3, 0.6, 1.0, 2.0}) {
      double in_time_m = 0.0, late_m = 0.0, open_m = 0.0, fastest = 0.0;
      for (int i = 0; i < extent(4, 40); ++i) {
        touch_case c = drawn_touch({std::min<std::int64_t>(period_ns, 1'000'000), period_ns}, speed, d);
        c.three_late_share = i % 2 == 0 ? 0.0 : 0.3;
        const touch_outcome o = run(c);
        EXPECT_LE(o.deepest_m, gives_way_m) << period_ns << ' ' << speed << ' ' << i;
        EXPECT_LE(o.surplus_j, no_energy_j) << period_ns << ' ' << speed << ' ' << i;
        EXPECT_LE(o.border_j, 1e-12);
        EXPECT_NEAR(o.open_j, 0.0, 1e-9);
        (i % 2 == 0 ? in_time_m : late_m) = std::max(i % 2 == 0 ? in_time_m : late_m, o.deepest_m);
        fastest = std::max(fastest, o.fastest_m_per_s);
        c.body.tells_known = false;
        const double without_m = run(c).deepest_m;
        entered += without_m > 2.0 * gives_way_m ? 1 : 0;
        open_m = std::max(open_m, without_m);
      }
      std::printf("| %.0f Hz | %.2f m/s | %.3f mm | %.3f mm | %.3f mm |\n", 1.0 / seconds(period_ns), fastest,
                  1e3 * in_time_m, 1e3 * late_m, 1e3 * open_m);
    }
  }
  EXPECT_GE(entered, 2) << "the control: without a border hands do not enter either";
}

// The last contact may be any: the probe goes as far as that one knows and waits there.
TEST(known_region, a_contact_that_never_comes_again_keeps_the_probe) {
  drawn d(seed_of(fresh_seed("known_region, stop", "20 touches"), "stop"));
  int waited = 0, left = 0;
  for (int i = 0; i < 20; ++i) {
    const std::int64_t period_ns = periods_ns[static_cast<std::size_t>(i) % periods_ns.size()];
    touch_case c = drawn_touch({std::min<std::int64_t>(period_ns, 1'000'000), period_ns}, d.between(0.3, 1.5), d);
    // The target goes on until the gate shuts, so that the probe is pulled all the time.
    c.control.ageing = {.hold_ns = 1'000'000'000, .fade_ns = 1'000'000'000};
    c.last_contact_ns = static_cast<std::int64_t>(1e9 * d.between(0.2, 0.6) * c.hand.motion.approach_s);
    const touch_outcome o = run(c);
    EXPECT_LE(o.deepest_m, gives_way_m) << i;
    EXPECT_LE(o.largest_share, 1.0 + 1e-9) << i;
    waited += o.largest_share > 1.0 - 1e-6 ? 1 : 0;
    c.body.tells_known = false;
    left += run(c).deepest_m > 1e-3 ? 1 : 0;
  }
  EXPECT_GE(waited, 5);
  EXPECT_GE(left, 2) << "the control: no hand enters without a border";
}

}  // namespace
