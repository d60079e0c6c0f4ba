// The dead-man button of the device panel, with drawn times of beats, spans and clocks.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>

#include "asperity/device/simulated/simulated_device.hpp"
#include "panel_loop.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::command {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// A loop with a simulated device that is armed, on a clock of the test's own.
struct bench {
  simulated_device device;
  panel_exchange shared;
  std::unique_ptr<panel_loop<simulated_device>> loop;
  std::int64_t period_ns;
  std::int64_t now_ns;
  force_wish wish{};

  bench(std::int64_t period, std::int64_t begin_ns, const panel_settings& more = {.offers_force = true})
      : device(settings()), period_ns(period), now_ns(begin_ns) {
    EXPECT_TRUE(device.open());
    EXPECT_TRUE(device.arm());
    panel_settings s = more;
    s.period_ns = period;
    loop = std::make_unique<panel_loop<simulated_device>>(device, s, shared);
  }
  static simulated_settings settings() {
    simulated_settings s;
    s.motion.kind = motion_kind::free;
    return s;
  }
  void publish() {
    shared.wish.back() = wish;
    shared.wish.publish();
  }
  void press(const vec3& force_d) {
    wish = {.press = wish.press + 1, .force_d = force_d, .beat_ns = now_ns};
    publish();
  }
  void beat() {
    ++wish.beats;
    wish.beat_ns = now_ns;
    publish();
  }
  double tick(std::int64_t gap_ns = 0) {
    now_ns += gap_ns > 0 ? gap_ns : period_ns;
    shared.application.fetch_add(1);
    loop->tick(now_ns);
    return glm::length(loop->gate().last().force);
  }
  /// Beats every `every_ns` for this long. @return the largest force
  double hold(std::int64_t length_ns, std::int64_t every_ns = 25 * ms) {
    double most = 0.0;
    std::int64_t next_ns = now_ns;
    for (const std::int64_t end_ns = now_ns + length_ns; now_ns < end_ns;) {
      if (now_ns >= next_ns) beat(), next_ns = now_ns + every_ns;
      most = std::max(most, tick());
    }
    return most;
  }
};

class panel : public testing::Test {
 protected:
  panel() : draws(test_support::seed_of(test_support::fresh_seed("panel", "60 presses"), "panel")) {}
  double draw(double low, double high) { return std::uniform_real_distribution<double>(low, high)(draws); }
  std::int64_t draw_ns(double low_ms, double high_ms) { return std::llround(1e6 * draw(low_ms, high_ms)); }
  bench fresh() { return {std::llround(1e9 / std::exp(draw(std::log(200.0), std::log(10000.0)))), draw_ns(0.0, 1e9)}; }

  std::mt19937_64 draws;
};

vec3 force_of(double n) { return {n, 0.0, 0.0}; }

TEST_F(panel, a_force_rises_while_the_button_is_held_and_ends_with_it) {
  for (int round = 0; round < 12; ++round) {
    bench b = fresh();
    const double n = draw(0.05, 1.0);
    for (int i = 0; i < 50; ++i) EXPECT_EQ(b.tick(), 0.0);
    b.press(force_of(n));
    EXPECT_EQ(b.tick(), 0.0) << "before the first beat";
    // Half of the rise: no more than half of the force.
    EXPECT_LE(b.hold(100 * ms), 0.5 * n + 0.05 * n);
    EXPECT_NEAR(b.hold(draw_ns(300.0, 600.0)), n, 1e-9);
    EXPECT_EQ(b.loop->gate().last().torque, vec3(0.0));
    b.wish.released = true;
    b.publish();
    const std::int64_t released_ns = b.now_ns;
    while (b.tick() > 0.0) ASSERT_LT(b.now_ns - released_ns, 60 * ms);
    b.beat();  // of a press that is over
    for (int i = 0; i < 100; ++i) EXPECT_EQ(b.tick(), 0.0);
    EXPECT_EQ(b.loop->button().end(), press_end::released);
    EXPECT_EQ(b.loop->gate().fault(), gate_fault::none);
    EXPECT_EQ(b.shared.over.load(), 1U);
    // The next press begins at zero.
    b.press(force_of(n));
    b.tick();
    EXPECT_LE(b.hold(20 * ms), 0.15 * n + 1e-12);
  }
}

TEST_F(panel, lost_beats_end_it_within_a_fifth_of_a_second) {
  for (int round = 0; round < 40; ++round) {
    bench b = fresh();
    b.press(force_of(draw(0.3, 1.0)));
    b.hold(draw_ns(150.0, 500.0), draw_ns(1.0, 80.0));
    ASSERT_TRUE(b.loop->button().holds());
    const std::int64_t last_ns = b.wish.beat_ns;
    std::int64_t zero_ns = 0;
    for (const std::int64_t end_ns = b.now_ns + 500 * ms; b.now_ns < end_ns;) {
      const std::int64_t gap_ns = draw(0.0, 1.0) < 0.1 ? draw_ns(1.0, 15.0) : 0;
      if (b.tick(gap_ns) > 0.0) zero_ns = b.now_ns;
    }
    EXPECT_GT(zero_ns - last_ns, 50 * ms) << "a beat may take its time";
    EXPECT_LE(zero_ns - last_ns, 200 * ms);
    EXPECT_EQ(b.loop->button().end(), press_end::lost_beats);
    // Whoever comes back late is not heard.
    b.beat();
    EXPECT_EQ(b.hold(draw_ns(50.0, 200.0)), 0.0);
    ASSERT_EQ(b.loop->records(), 1U);
    const press_record& r = b.loop->record(0);
    EXPECT_LE(r.zero_ns - r.last_beat_ns, 200 * ms);
    EXPECT_LE(b.loop->longest_without_beat_ns(), 200 * ms);
  }
}

TEST_F(panel, what_a_server_says_of_the_time_prolongs_nothing) {
  bench b = fresh();
  b.press(force_of(1.0));
  b.hold(300 * ms);
  ASSERT_TRUE(b.loop->button().holds());
  b.wish.beat_ns = std::numeric_limits<std::int64_t>::max() / 2;
  b.publish();
  for (const std::int64_t end_ns = b.now_ns + 200 * ms; b.now_ns < end_ns;) b.tick();
  EXPECT_TRUE(b.loop->gate().at_rest());
  EXPECT_EQ(b.loop->button().end(), press_end::lost_beats);
}

TEST_F(panel, beats_slower_than_a_tenth_of_a_second_do_not_hold_it) {
  bench b = fresh();
  b.press(force_of(1.0));
  b.hold(150 * ms);
  ASSERT_TRUE(b.loop->button().holds());
  b.hold(400 * ms, draw_ns(120.0, 300.0));
  EXPECT_EQ(b.loop->button().end(), press_end::lost_beats);
}

TEST_F(panel, a_loop_that_stood_still_counts_the_gap_as_silence) {
  bench b = fresh();
  b.press(force_of(1.0));
  b.hold(300 * ms);
  ASSERT_TRUE(b.loop->button().holds());
  b.beat();  // may have come at any time in the gap
  b.tick(draw_ns(110.0, 240.0));
  EXPECT_EQ(b.loop->button().end(), press_end::lost_beats);
  EXPECT_EQ(b.hold(200 * ms), 0.0);
}

TEST_F(panel, a_press_without_a_first_beat_in_time_is_over) {
  bench b = fresh();
  b.press(force_of(1.0));
  for (const std::int64_t end_ns = b.now_ns + 300 * ms; b.now_ns < end_ns;) EXPECT_EQ(b.tick(), 0.0);
  EXPECT_EQ(b.loop->button().end(), press_end::not_begun);
  EXPECT_EQ(b.hold(300 * ms), 0.0);
  EXPECT_EQ(b.loop->presses(), 0U);
}

TEST_F(panel, an_older_press_is_never_taken_up_again) {
  bench b = fresh();
  b.press(force_of(1.0));
  const force_wish old = b.wish;
  b.hold(300 * ms);
  b.press(force_of(0.5));
  b.hold(300 * ms);
  ASSERT_TRUE(b.loop->button().holds());
  b.wish = old;
  b.hold(70 * ms);  // long enough for the way to zero, and for an old press to have begun again
  EXPECT_EQ(b.hold(300 * ms), 0.0);
}

TEST_F(panel, nothing_but_an_ordinary_force_within_the_limit_is_taken) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  for (const vec3& force : {force_of(nan), force_of(infinite), force_of(-infinite), force_of(1.001), force_of(1e308),
                            vec3(0.9, 0.9, 0.0), vec3(0.1, nan, 0.0)}) {
    bench b = fresh();
    b.press(force);
    EXPECT_EQ(b.hold(400 * ms), 0.0);
    EXPECT_EQ(b.loop->button().end(), press_end::refused);
    EXPECT_EQ(b.loop->gate().fault(), gate_fault::none);
  }
}

TEST_F(panel, a_force_that_changes_within_a_press_is_not_followed) {
  bench b = fresh();
  b.press(force_of(0.2));
  b.hold(300 * ms);
  b.wish.force_d = force_of(1.0);
  EXPECT_LE(b.hold(300 * ms), 0.2 + 1e-9);
}

TEST_F(panel, the_gate_has_the_last_word) {
  for (const gate_fault cause : {gate_fault::stopped, gate_fault::interrupted, gate_fault::device_failed}) {
    bench b = fresh();
    b.press(force_of(1.0));
    b.hold(400 * ms);
    b.loop->stop(cause);
    const std::int64_t stopped_ns = b.now_ns;
    std::int64_t next_ns = b.now_ns, last_ns = b.now_ns;
    while (b.now_ns < stopped_ns + 400 * ms) {
      if (b.now_ns >= next_ns) b.beat(), next_ns = b.now_ns + 25 * ms;
      if (b.tick() > 0.0) last_ns = b.now_ns;
    }
    EXPECT_LE(last_ns - stopped_ns, 60 * ms);
    EXPECT_EQ(b.loop->button().end(), press_end::shut);
    EXPECT_FALSE(may_put_out(b.device.state()));
    b.press(force_of(1.0));
    EXPECT_EQ(b.hold(400 * ms), 0.0);
  }
}

TEST_F(panel, a_silent_program_shuts_the_gate) {
  bench b = fresh();
  b.press(force_of(1.0));
  b.hold(300 * ms);
  for (const std::int64_t end_ns = b.now_ns + 1200 * ms; b.now_ns < end_ns;) {
    b.beat();
    b.now_ns += b.period_ns;
    b.loop->tick(b.now_ns);
  }
  EXPECT_EQ(b.loop->gate().fault(), gate_fault::watchdog);
  EXPECT_TRUE(b.loop->gate().at_rest());
}

TEST_F(panel, without_an_offer_nothing_is_put_out) {
  bench b(1 * ms, 0, {.offers_force = false});
  b.press(force_of(0.5));
  EXPECT_EQ(b.hold(400 * ms), 0.0);
  EXPECT_EQ(b.loop->most_n(), 0.0);
}

TEST_F(panel, a_device_that_leaves_ends_it) {
  bench b = fresh();
  b.press(force_of(1.0));
  b.hold(300 * ms);
  b.device.unplug();
  b.hold(300 * ms);
  EXPECT_EQ(b.loop->gate().fault(), gate_fault::device_departed);
  EXPECT_TRUE(b.loop->gate().at_rest());
  EXPECT_EQ(b.loop->button().end(), press_end::shut);
}

TEST(panel_force, is_at_most_what_a_device_can_hold_and_take_away_in_time) {
  device_capabilities c = simulated_capabilities();
  EXPECT_EQ(test_force_of(c), 1.0);
  c.continuous_force_n = 0.4;
  EXPECT_EQ(test_force_of(c), 0.4);
  c.force_slew_n_per_s = 2.0;
  EXPECT_NEAR(test_force_of(c), 0.1, 1e-12);
  c.force_slew_n_per_s = 0.0;
  EXPECT_EQ(test_force_of(c), 0.0);
  c = simulated_capabilities();
  c.actuated = rotation_axes;
  EXPECT_EQ(test_force_of(c), 0.0);
  c = simulated_capabilities();
  c.peak_force_n = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(test_force_of(c) > 1.0);
}

}  // namespace
}  // namespace asperity::command
