// Lateness in, one factor out: every limit from both sides, by times that are written down here.
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>

#include <asperity/control/rate_monitor.hpp>

#include "session/simulation/dice.hpp"

namespace rate_monitor_test {

using namespace asperity;

constexpr std::int64_t ms = 1'000'000;

rate_limits at_1_khz() {
  rate_limits l;
  l.period_ns = ms;
  return l;
}

// Ticks of one kind for a time. @return the last verdict
rate_verdict tick_for(rate_monitor& m, std::int64_t time_ns, std::int64_t gap_ns) {
  rate_verdict v;
  for (std::int64_t t = 0; t < time_ns; t += gap_ns) v = m.judge(gap_ns, gap_ns > 20 * ms, ms, true);
  return v;
}

// The first fault that ticks of one kind lead to, and when.
struct shut_at {
  gate_fault fault = gate_fault::none;
  double after_s = 0.0;
};
template <class Gap>
shut_at tick_until_shut(rate_monitor& m, double most_s, Gap gap_ns) {
  double passed_s = 0.0;
  for (int i = 0; passed_s < most_s; ++i) {
    const std::int64_t gap = gap_ns(i);
    passed_s += 1e-9 * static_cast<double>(gap);
    const rate_verdict v = m.judge(gap, gap > 20 * ms, ms, true);
    if (v.fault != gate_fault::none) return {v.fault, passed_s};
  }
  return {};
}

TEST(rate_monitor, leaves_a_punctual_loop_alone_to_the_bit) {
  rate_monitor m(at_1_khz());
  simulation::dice d(7);
  std::int64_t due_ns = 0;
  std::int64_t last_ns = 0;
  for (int i = 0; i < 100'000; ++i, due_ns += ms) {
    // Up to 0.9 of a period late, each tick by itself, as sleeps on an ordinary kernel are.
    const std::int64_t at_ns = due_ns + static_cast<std::int64_t>(d.between(0.0, 0.9e6));
    const rate_verdict v = m.judge(at_ns - last_ns, false, at_ns % (40 * ms), true);
    last_ns = at_ns;
    ASSERT_EQ(v.scale, 1.0) << i;
    ASSERT_EQ(v.fault, gate_fault::none) << i;
  }
  EXPECT_EQ(m.report().lost_periods, 0U);
  EXPECT_EQ(m.report().ticks, 100'000U);
}

// With n - 1 of n periods left out the share tends to (n - 1) / n.
TEST(rate_monitor, fades_with_the_share_of_periods_left_out_and_then_shuts) {
  const auto steady_scale = [](int of_ten) {
    rate_monitor m(at_1_khz());
    double scale = 1.0;
    for (int second = 0; second < 5; ++second) {
      for (int block = 0; block < 100; ++block) {  // ten periods with `of_ten` left out, the ticks spread evenly
        int owed = 0;
        std::int64_t gap = 0;
        for (int i = 0; i < 10; ++i) {
          gap += ms;
          owed += 10 - of_ten;
          if (owed < 10) continue;
          owed -= 10;
          scale = m.judge(gap, false, ms, true).scale;
          gap = 0;
        }
      }
    }
    return scale;
  };
  EXPECT_EQ(steady_scale(0), 1.0);
  EXPECT_EQ(steady_scale(2), 1.0);
  EXPECT_NEAR(steady_scale(3), (0.45 - 0.3) / 0.2, 0.05);
  EXPECT_NEAR(steady_scale(4), (0.45 - 0.4) / 0.2, 0.05);
  EXPECT_EQ(steady_scale(5), 0.0);

  // Two of three left out pass 0.45 after 0.5 s * ln(0.667 / 0.217) = 0.56 s; two seconds of silence later it is over.
  rate_monitor m(at_1_khz());
  const shut_at end = tick_until_shut(m, 10.0, [](int) { return 3 * ms; });
  EXPECT_EQ(end.fault, gate_fault::overloaded);
  EXPECT_NEAR(end.after_s, 2.56, 0.03);
  EXPECT_NEAR(static_cast<double>(m.report().lost_periods), 2.0 / 3.0 * 2560.0, 30.0);
}

// Ticks that came too early are no provision for later ones.
TEST(rate_monitor, gives_no_credit_for_early_ticks) {
  rate_monitor m(at_1_khz());
  EXPECT_EQ(tick_for(m, 2'000 * ms, ms / 2).scale, 1.0);
  const shut_at end = tick_until_shut(m, 10.0, [](int) { return 3 * ms; });
  EXPECT_EQ(end.fault, gate_fault::overloaded);
  EXPECT_NEAR(end.after_s, 2.56, 0.03);
}

TEST(rate_monitor, judges_no_share_without_a_period) {
  rate_monitor m;
  EXPECT_EQ(tick_for(m, 5'000 * ms, 10 * ms).scale, 1.0);
  EXPECT_EQ(m.report().lost_periods, 0U);
}

TEST(rate_monitor, is_silent_after_a_lapse_and_rises_evenly) {
  rate_monitor m(at_1_khz());
  EXPECT_EQ(tick_for(m, 100 * ms, ms).scale, 1.0);
  const rate_verdict lapse = m.judge(21 * ms, true, ms, true);
  EXPECT_EQ(lapse.scale, 0.0);
  EXPECT_TRUE(lapse.settling);
  EXPECT_TRUE(lapse.blind);
  EXPECT_EQ(lapse.fault, gate_fault::none);
  for (int i = 1; i < 50; ++i) ASSERT_EQ(m.judge(ms, false, ms, true).scale, 0.0) << i;
  for (int i = 50; i < 250; ++i) ASSERT_NEAR(m.judge(ms, false, ms, true).scale, (i - 49) / 200.0, 1e-9) << i;
  EXPECT_EQ(tick_for(m, 10 * ms, ms).scale, 1.0);
  EXPECT_EQ(m.report().lapses, 1U);
  EXPECT_EQ(m.report().longest_gap_ns, 21 * ms);
}

TEST(rate_monitor, waits_for_the_probe_and_gives_up_in_the_end) {
  rate_monitor m(at_1_khz());
  static_cast<void>(m.judge(21 * ms, true, ms, true));
  int i = 0;
  rate_verdict v;
  for (; v.fault == gate_fault::none && i < 10'000; ++i) {
    v = m.judge(ms, false, ms, false);  // the target never reaches the hand
    ASSERT_EQ(v.scale, 0.0);
  }
  EXPECT_EQ(v.fault, gate_fault::overloaded);
  EXPECT_NEAR(i, 2000 - 21, 2);
}

TEST(rate_monitor, shuts_after_one_gap_that_is_too_long_or_many_that_are_not) {
  rate_monitor one(at_1_khz());
  EXPECT_EQ(one.judge(250 * ms, true, ms, true).fault, gate_fault::none);
  EXPECT_EQ(one.judge(250 * ms + 1, true, ms, true).fault, gate_fault::stalled);

  rate_monitor many(at_1_khz());
  const shut_at end = tick_until_shut(many, 10.0, [](int i) { return (i % 50 == 49 ? 30 : 1) * ms; });
  EXPECT_EQ(end.fault, gate_fault::stalled);
  EXPECT_EQ(many.report().lapses, 6U);

  rate_monitor rare(at_1_khz());
  EXPECT_EQ(tick_until_shut(rare, 60.0, [](int i) { return (i % 1100 == 1099 ? 30 : 1) * ms; }).fault,
            gate_fault::none);
}

TEST(rate_monitor, does_not_let_an_old_contact_be_felt) {
  rate_monitor m(at_1_khz());
  EXPECT_EQ(m.judge(ms, false, 50 * ms, true).scale, 1.0);
  EXPECT_DOUBLE_EQ(m.judge(ms, false, 75 * ms, true).scale, 0.5);
  // A fresh one does not bring it back at once: a loop that is late again and again would pulse.
  EXPECT_NEAR(m.judge(ms, false, ms, true).scale, 0.505, 1e-9);
  const rate_verdict lapsed = m.judge(ms, false, 100 * ms, true);
  EXPECT_EQ(lapsed.scale, 0.0);
  EXPECT_TRUE(lapsed.blind);
  for (int i = 101; i <= 1000; ++i) ASSERT_EQ(m.judge(ms, false, i * ms, true).fault, gate_fault::none) << i;
  EXPECT_EQ(m.judge(ms, false, 1000 * ms + 1, true).fault, gate_fault::contact_stalled);
  EXPECT_EQ(m.report().contact_lapses, 1U);
  EXPECT_EQ(m.report().oldest_contact_ns, 1000 * ms + 1);
}

TEST(rate_monitor, shuts_where_contacts_lapse_again_and_again) {
  rate_monitor m(at_1_khz());
  gate_fault fault = gate_fault::none;
  int lapses = 0;
  for (int i = 0; fault == gate_fault::none && i < 5000; ++i) {
    fault = m.judge(ms, false, (i % 110) * ms, true).fault;
    lapses += i % 110 == 100 ? 1 : 0;
  }
  EXPECT_EQ(fault, gate_fault::contact_stalled);
  EXPECT_EQ(lapses, 6);
}

TEST(rate_monitor, begins_anew_and_goes_on_counting) {
  rate_monitor m(at_1_khz());
  static_cast<void>(m.judge(21 * ms, true, ms, true));
  m.restart();
  EXPECT_EQ(m.judge(ms, false, rate_monitor::no_contact, true).scale, 1.0);
  EXPECT_EQ(m.report().lapses, 1U);
  EXPECT_EQ(m.report().ticks, 2U);
}

}  // namespace rate_monitor_test
