// Device and contact loop at rates of their own, from 200 Hz to 10 kHz, against bodies of known planes: the probe is
// held, no hand receives energy, and contacts are as old as the two periods make them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>

#include <asperity/control/virtual_coupling.hpp>
#include <asperity/planes/plane_renderer.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double no_energy_j = 1e-5;  // the guard's tolerance: rounding and the encoder's steps
constexpr std::array<std::int64_t, 4> periods_ns{5'000'000, 1'000'000, 250'000, 100'000};

/// Calls with every pair of periods. @param call takes loop_periods
template <class Call>
void for_each_pair(Call&& call) {
  for (const std::int64_t device_ns : periods_ns) {
    for (const std::int64_t contact_ns : periods_ns) call(loop_periods{device_ns, contact_ns});
  }
}

virtual_schedule late(const loop_periods& p) {
  return {.device_period_ns = p.device_ns, .contact_period_ns = p.contact_ns, .contact_one_period_late = true};
}

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// A block over a plate of 1 mm or 20 mm, a drawn hand, and gaps told as far as these periods need.
plane_case drawn_case(const loop_periods& p, int kind, int i, drawn& d) {
  plane_case c;
  c.body = block_on_plate(i % 2 == 0 ? 0.001 : 0.02);
  c.body.reported_gap_m = reach_for(seconds(p.contact_ns), seconds(p.device_ns));
  c.control.guard.enabled = false;
  c.control.coupling = coupling_for(simulated_capabilities(), 1.0 / seconds(p.device_ns));
  const double part = d.log_between(0.3, 1.0);
  c.control.coupling.stiffness_n_per_m *= part;
  c.control.coupling.stiffness_n_m_per_rad *= part;
  c.schedule = late(p);
  c.length_s = 0.7;
  draw_hand(c.hand, kind, d);
  return c;
}

TEST(loop_rates, hold_the_probe_and_make_no_energy) {
  drawn d(seed_of(fresh_seed("loop_rates", "48 sessions, 480 at length"), "hands"));
  const int each = extent(1, 10);
  std::printf("| device | contact, late | deepest | most energy |\n|---|---|---|---|\n");
  for_each_pair([&](const loop_periods& p) {
    double deepest_m = 0.0, surplus_j = 0.0;
    for (int kind = 0; kind < hand_kinds; ++kind) {
      for (int i = 0; i < each; ++i) {
        const plane_outcome o = run(drawn_case(p, kind, kind + i, d));
        EXPECT_EQ(o.not_ok, 0U);
        EXPECT_LE(o.unbalanced_n, 1e-7);
        EXPECT_LE(o.surplus_j, no_energy_j) << p.device_ns << ' ' << p.contact_ns << " hand " << kind;
        EXPECT_LT(o.deepest_m, 4e-4) << p.device_ns << ' ' << p.contact_ns << " hand " << kind;  // of a plate of 1 mm
        deepest_m = std::max(deepest_m, o.deepest_m);
        surplus_j = std::max(surplus_j, o.surplus_j);
      }
    }
    std::printf("| %.0f Hz | %.0f Hz | %.3f mm | %.4f mJ |\n", 1.0 / seconds(p.device_ns), 1.0 / seconds(p.contact_ns),
                1e3 * deepest_m, 1e3 * surplus_j);
  });
}

// A contact loop that is faster than the device loop has to look as far as the device loop's period asks for.
TEST(loop_rates, a_slow_device_loop_needs_its_own_reach) {
  drawn d(seed_of(fresh_seed("loop_rates_reach", "6 sessions"), "reach"));
  const loop_periods p{5'000'000, 250'000};
  double near_m = 0.0;
  for (int i = 0; i < 6; ++i) {
    plane_case c = drawn_case(p, 2, i, d);
    EXPECT_LT(run(c).deepest_m, 4e-4) << i;
    c.body.reported_gap_m = reach_for(seconds(p.contact_ns));
    c.body.tells_known = false;
    near_m = std::max(near_m, run(c).deepest_m);
  }
  EXPECT_GT(near_m, 4e-4);
}

struct ages {
  static constexpr std::int64_t settled_ns = 50'000'000;  // before, there may be no contact yet
  std::uint64_t ticks = 0;
  std::int64_t least_ns = 1LL << 60, most_ns = 0, last_time_ns = -1;
  void operator()(const session_record& r) noexcept {
    last_time_ns = r.time_ns;
    ++ticks;
    if (r.time_ns < settled_ns) return;
    least_ns = std::min(least_ns, r.contact_age_ns);
    most_ns = std::max(most_ns, r.contact_age_ns);
  }
};

TEST(loop_rates, say_how_old_contacts_are) {
  std::int64_t age_at_1khz_ns = 0;
  for_each_pair([&](const loop_periods& p) {
    simulated_device dev;
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<plane_body, simulated_device, ages> session(block_on_plane(), {{pose{}}, vec3(0.0)}, dev,
                                                                control_settings{}, late(p));
    constexpr std::int64_t length_ns = 1'000'000'000;
    static_cast<void>(session.run_until(length_ns));
    const ages& seen = session.device().observer();
    EXPECT_EQ(seen.ticks, static_cast<std::uint64_t>(length_ns / p.device_ns));
    EXPECT_EQ(seen.last_time_ns, length_ns - p.device_ns);
    // A contact tick for each period, and a contact for each that found a new pose.
    EXPECT_NEAR(static_cast<double>(session.contact_ticks()), static_cast<double>(length_ns / p.contact_ns), 50.0);
    EXPECT_NEAR(static_cast<double>(session.contact().computed()), static_cast<double>(length_ns / p.renewal_ns()), 2.0)
        << p.device_ns << ' ' << p.contact_ns;
    EXPECT_GE(seen.least_ns, p.contact_ns);
    EXPECT_LT(seen.most_ns, p.oldest_contact_ns()) << p.device_ns << ' ' << p.contact_ns;
    EXPECT_GE(seen.most_ns, p.renewal_ns());
    if (p.device_ns == 1'000'000 && p.contact_ns == 1'000'000) age_at_1khz_ns = seen.most_ns;
    // What a contact loop faster than the device loop is for: contacts of the tick before, and not of two before.
    if (p.device_ns == 1'000'000 && p.contact_ns < 500'000) {
      EXPECT_EQ(age_at_1khz_ns, 2'000'000);
      EXPECT_EQ(seen.most_ns, 1'000'000);
    }
  });
}

TEST(loop_rates, settings_follow_both_periods) {
  for_each_pair([&](const loop_periods& p) {
    const control_settings c = with_periods({}, p);
    EXPECT_EQ(c.rates.period_ns, p.device_ns);
    EXPECT_GT(c.rates.surprise_age_ns, p.oldest_contact_ns());
    EXPECT_LT(c.rates.surprise_age_ns, c.ageing.hold_ns);
    EXPECT_GE(reach_for(seconds(p.contact_ns), seconds(p.device_ns)), 0.59 * seconds(p.oldest_contact_ns()));
    EXPECT_GE(reach_for(seconds(p.contact_ns), seconds(p.device_ns)), reach_for(seconds(p.contact_ns)));
  });
  EXPECT_EQ(reach_for(1e-3, 1e-3), reach_for(1e-3));
  EXPECT_EQ(reach_for(5e-3, 1e-3), reach_for(5e-3));
  EXPECT_EQ((loop_periods{1'000'000, 250'000}.renewal_ns()), 1'000'000);
  EXPECT_EQ((loop_periods{250'000, 1'000'000}.renewal_ns()), 1'000'000);
  control_settings own;
  own.rates.period_ns = 7;
  own.rates.surprise_age_ns = 1'000'000'000;
  EXPECT_EQ(with_periods(own, {}).rates.period_ns, 7);
  EXPECT_EQ(with_periods(own, {}).rates.surprise_age_ns, 1'000'000'000);
  // At 100 Hz a contact that is replaced in time is 30 ms old: that is no surprise.
  EXPECT_GT(with_periods({}, {10'000'000, 10'000'000}).rates.surprise_age_ns, 30'000'000);
}

// What a surprise puts out is nothing for 50 ms: a touch at 100 Hz must not be taken for one.
TEST(loop_rates, a_hundred_hertz_is_no_surprise) {
  drawn d(seed_of(fresh_seed("loop_rates_surprise", "4 sessions"), "surprise"));
  for (int i = 0; i < 4; ++i) {
    plane_case c = drawn_case({10'000'000, 10'000'000}, 1, i, d);
    simulated_device dev(c.hand);
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<plane_body, simulated_device> session(c.body, {{pose{}}, vec3(0.0)}, dev, c.control, c.schedule);
    static_cast<void>(session.run_until(700'000'000));
    EXPECT_EQ(session.device().rates().report().surprises, 0U) << i;
    EXPECT_EQ(session.device().rates().report().lapses, 0U) << i;
    EXPECT_EQ(session.device().gate().fault(), gate_fault::none) << i;
  }
}

}  // namespace
