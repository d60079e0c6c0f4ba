// Sessions at rates of their own on either clock, and the look at a machine's speed before them.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "asperity/device/simulated/simulated_device.hpp"
#include "rate_check.hpp"
#include "render_choice.hpp"
#include "session.hpp"
#include "support/fresh_seed.hpp"
#include "support/sanitizers.hpp"
#include "support/small_models.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using namespace asperity::command;

constexpr std::array<std::int64_t, 4> periods_ns{5'000'000, 1'000'000, 250'000, 100'000};

/// The analytic wall as a renderer that a command can hold, and that takes its time.
struct slow_wall : test_support::analytic_wall {
  std::chrono::microseconds takes{0};
  asperity::scene nothing{};

  [[nodiscard]] const asperity::scene& scene() const noexcept { return nothing; }
  [[nodiscard]] static std::size_t memory_bytes() noexcept { return 0; }
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const auto until = std::chrono::steady_clock::now() + takes;
    while (std::chrono::steady_clock::now() < until) {
    }
    return analytic_wall::step(at, out);
  }
};

struct session_log {
  std::vector<session_record> ticks;
  session_outcome ended;
};

session_log run(any_renderer feel, const scene_placement& placement, const simulated_settings& hand,
                const control_settings& control, session_clock clock, const loop_periods& periods, double seconds) {
  session_log log;
  any_device device{simulated_device(hand)};
  EXPECT_TRUE(device.open());
  progress_line quiet(true);
  result<session_outcome> ended = run_session({.feel = std::move(feel),
                                               .placement = placement,
                                               .device = std::move(device),
                                               .control = control,
                                               .clock = clock,
                                               .seconds = seconds,
                                               .periods = periods,
                                               .on_tick = [&](const session_record& r) -> result<void> {
                                                 log.ticks.push_back(r);
                                                 return {};
                                               }},
                                              quiet);
  EXPECT_TRUE(ended);
  if (ended) log.ended = std::move(*ended);
  return log;
}

simulated_settings pressing_hand(std::uint64_t seed) {
  return {.seed = seed, .motion = {.depth_m = 0.01, .approach_s = 0.05}};
}

TEST(rates, of_a_virtual_session_are_those_asked_for) {
  const std::uint64_t seed = test_support::fresh_seed("rates_virtual", "16 sessions");
  constexpr double seconds = 0.15;
  for (const std::int64_t device_ns : periods_ns) {
    for (const std::int64_t contact_ns : periods_ns) {
      const loop_periods p{device_ns, contact_ns};
      const session_log log = run(any_renderer(slow_wall{}), {{pose{}}, vec3(0.0)}, pressing_hand(seed), {},
                                  session_clock::virtual_time, p, seconds);
      const auto ticks =
          static_cast<std::uint64_t>(std::llround(seconds * 1e9)) / static_cast<std::uint64_t>(device_ns);
      EXPECT_EQ(log.ended.device.ticks, ticks);
      EXPECT_EQ(log.ended.fault, gate_fault::none);
      EXPECT_EQ(log.ended.rates.lost_periods, 0U);
      EXPECT_EQ(log.ended.rates.lowest_scale, 1.0);
      ASSERT_GT(log.ticks.size(), ticks);  // the wrench winds down
      double largest_n = 0.0;
      for (std::size_t i = 0; i < log.ticks.size(); ++i) {
        ASSERT_EQ(log.ticks[i].time_ns, static_cast<std::int64_t>(i) * device_ns);
        largest_n = std::max(largest_n, glm::length(log.ticks[i].on_hand_d.force));
      }
      EXPECT_GT(largest_n, 0.2) << device_ns << ' ' << contact_ns;
      EXPECT_EQ(glm::length(log.ticks.back().on_hand_d.force), 0.0);
      // A pose is rendered once; the other ticks of a faster contact loop find none.
      EXPECT_LE(log.ended.contact.ticks, ticks);
      EXPECT_GE(log.ended.contact.ticks + 2,
                ticks * static_cast<std::uint64_t>(device_ns) / static_cast<std::uint64_t>(p.renewal_ns()));
      EXPECT_EQ(log.ended.contact.idle > ticks / 2, contact_ns < device_ns) << device_ns << ' ' << contact_ns;
      EXPECT_EQ(log.ended.contact.over_period, log.ended.contact.late);
    }
  }
}

TEST(rates, of_a_session_in_real_time_are_counted) {
  const std::uint64_t seed = test_support::fresh_seed("rates_real", "4 sessions");
  for (const loop_periods& p :
       {loop_periods{1'000'000, 250'000}, {5'000'000, 100'000}, {250'000, 1'000'000}, {100'000, 100'000}}) {
    const session_log log = run(any_renderer(slow_wall{}), {{pose{}}, vec3(0.0)}, pressing_hand(seed), {},
                                session_clock::real_time, p, 0.2);
    ASSERT_FALSE(log.ticks.empty());
    for (std::size_t i = 1; i < log.ticks.size(); ++i) EXPECT_GE(log.ticks[i].time_ns, log.ticks[i - 1].time_ns);
    const loop_times& contact = log.ended.contact;
    // A session that a busy machine ends late has more ticks than room for their times was made at its start.
    const double room = 1.1 * 0.2e9 / static_cast<double>(std::min(p.device_ns, p.contact_ns)) + 1000.0;
    EXPECT_EQ(contact.seconds.size(), std::min(contact.ticks, static_cast<std::uint64_t>(room)))
        << "idle ticks are not timed";
    EXPECT_LE(contact.over_period, contact.ticks);
    EXPECT_LE(contact.ticks, log.ended.device.ticks + 1) << "a pose is rendered once";
  }
}

TEST(rate_check, says_that_a_slow_renderer_does_not_keep_its_rate) {
  slow_wall wall;
  wall.takes = std::chrono::microseconds(2100);
  any_renderer feel(wall);
  const rate_check slow = check_rate(feel, {{pose{}}, vec3(0.0)}, {}, {}, {});
  EXPECT_FALSE(slow.kept);
  EXPECT_GE(slow.tick.p50_s, 2.1e-3);
  EXPECT_GE(slow.tick.count, 5U);
  EXPECT_LE(slow.tick.count, 200U);
  EXPECT_LE(slow.kept_rate_hz.value_or(0.0), 250.0);
  const std::string told = to_text(slow);
  EXPECT_NE(told.find("of 1 ms here"), std::string::npos) << told;
  EXPECT_NE(told.find("the rate is not kept; use "), std::string::npos) << told;
  EXPECT_NE(told.find("coarser models"), std::string::npos) << told;
}

TEST(rate_check, judges_by_the_99th_percentile) {
  rate_check c{.period_s = 1e-3,
               .tick = {.count = 200, .mean_s = 6e-4, .p50_s = 6.2e-4, .p99_s = 9e-4, .max_s = 4e-3},
               .kept = true};
  EXPECT_EQ(to_text(c), "contact loop: a tick takes 620 us of 1 ms here (p99 900 us): the rate is kept");
  c.kept = false;
  c.processor_p99_s = 9e-4;
  EXPECT_EQ(to_text(c),
            "contact loop: a tick takes 620 us of 1 ms here (p99 900 us): the rate is not kept, because other programs "
            "hold the processor: end some of them");
  c.processor_p99_s = 1.1e-3;
  c.kept_rate_hz = 500.0;
  EXPECT_EQ(
      to_text(c),
      "contact loop: a tick takes 620 us of 1 ms here (p99 900 us): the rate is not kept; use --contact-rate 500, "
      "or coarser models");
  EXPECT_EQ(rate_within(0.79e-3), 1000.0);
  EXPECT_EQ(rate_within(0.81e-3), 800.0);
  EXPECT_EQ(rate_within(1e-6), 10'000.0);
  EXPECT_EQ(rate_within(8e-3), 100.0);
  EXPECT_EQ(rate_within(8.1e-3), std::nullopt);
  EXPECT_EQ(advice_for(std::nullopt), "use coarser models");
  EXPECT_EQ(advice_for(std::nullopt, 2), "use --threads 2, or coarser models");
  EXPECT_EQ(advice_for(400.0, 3), "use --threads 3, --contact-rate 400, or coarser models");
}

TEST(rate_check, offers_threads_where_there_are_processors_for_them) {
  render_options planes;
  planes.usual_contacts = "planes";
  for (const unsigned few : {0U, 1U, 2U, 3U}) EXPECT_EQ(more_threads(planes, few), std::nullopt) << few;
  EXPECT_EQ(more_threads(planes, 4), 2U);
  EXPECT_EQ(more_threads(planes, 64), 4U);
  planes.threads = 3;
  EXPECT_EQ(more_threads(planes, 5), std::nullopt);
  EXPECT_EQ(more_threads(planes, 6), 4U);
  const render_options one_potential;
  EXPECT_EQ(more_threads(one_potential, 64), std::nullopt);
}

// A look at the speed before a session leaves no trace in it.
TEST(rate_check, changes_no_bit_of_the_session) {
  if (ASPERITY_THREAD_SANITIZER) GTEST_SKIP() << "it has one thread: the other builds run it";
  using test_support::make_textured_box;
  const auto cube = std::make_shared<const textured_model>(
      make_textured_box({0.006, 0.006, 0.006}, 48, test_support::ridges(0.0002, 0.003)));
  const auto plate = std::make_shared<const textured_model>(
      make_textured_box({0.04, 0.04, 0.01}, 96, test_support::ridges(0.0003, 0.01)));
  const scene_placement placement{{{quat(1.0, 0.0, 0.0, 0.0), {0.0, 0.0, -0.0103}}}, cube->mass.centre_of_mass};
  const std::uint64_t seed = test_support::fresh_seed("rate_check", "2 sessions of each formulation");
  simulated_settings hand = pressing_hand(seed);
  hand.motion.kind = motion_kind::scrub;
  hand.motion.T_dh.position.z = 0.0085;
  control_settings control;
  control.probe = solid_probe(cube->mass);
  for (const char* contacts : {"planes", "least-motion"}) {
    std::vector<session_log> logs;
    for (const bool looked : {false, true}) {
      render_options options;
      options.contacts = contacts;
      result<any_renderer> feel = make_chosen_renderer({cube, {plate}}, options);
      ASSERT_TRUE(feel) << feel.error().message;
      if (looked) {
        const pose touch_T_wa{quat(1.0, 0.0, 0.0, 0.0), {0.001, 0.0005, 0.0058}};
        EXPECT_GT(check_rate(*feel, placement, touch_T_wa, control, {}).tick.count, 0U);
      }
      logs.push_back(run(std::move(*feel), placement, hand, control, session_clock::virtual_time, {}, 0.2));
    }
    ASSERT_EQ(logs[0].ticks.size(), logs[1].ticks.size());
    double largest_n = 0.0;
    for (std::size_t i = 0; i < logs[0].ticks.size(); ++i) {
      const session_record &a = logs[0].ticks[i], &b = logs[1].ticks[i];
      ASSERT_EQ(a.T_wa.position, b.T_wa.position) << contacts << ' ' << i;
      ASSERT_EQ(a.on_hand_d.force, b.on_hand_d.force) << contacts << ' ' << i;
      ASSERT_EQ(a.on_probe_w.torque, b.on_probe_w.torque) << contacts << ' ' << i;
      ASSERT_EQ(a.max_depth_m, b.max_depth_m) << contacts << ' ' << i;
      ASSERT_EQ(a.planes, b.planes) << contacts << ' ' << i;
      ASSERT_EQ(a.flags, b.flags) << contacts << ' ' << i;
      largest_n = std::max(largest_n, glm::length(a.on_hand_d.force));
    }
    EXPECT_GT(largest_n, 0.2) << contacts;
  }
}

}  // namespace
