// What the monitor of vibration tells, against closed forms.
#include "asperity/control/vibration_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "session/rt/tick_trap.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using test_support::fresh_seed;
using test_support::seed_of;

constexpr double pi = std::numbers::pi;

/// Share of a sine that Butterworth's high-pass of order 4, bilinear and prewarped, lets through.
double share(double frequency_hz, double rate_hz) {
  const double x = std::tan(60.0 * pi / rate_hz) / std::tan(pi * frequency_hz / rate_hz);
  return 1.0 / std::sqrt(1.0 + std::pow(x, 8.0));
}

/// Share of white noise's rms that it lets through.
double noise_share(double rate_hz) {
  constexpr int steps = 20000;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double s = share(0.5 * rate_hz * (i + 0.5) / steps, rate_hz);
    sum += s * s;
  }
  return std::sqrt(sum / steps);
}

/// Numbers that are the same on every machine.
class numbers {
 public:
  explicit numbers(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1.0p-53;
  }
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += (*this)(0.0, 1.0);
    return sum;
  }
  vec3 direction() {
    for (;;) {
      const vec3 v((*this)(-1.0, 1.0), (*this)(-1.0, 1.0), (*this)(-1.0, 1.0));
      const double l = glm::dot(v, v);
      if (l > 0.01 && l < 1.0) return v / std::sqrt(l);
    }
  }

 private:
  std::mt19937_64 engine_;
};

constexpr double usual_rates_hz[] = {200.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 10000.0};

/// A session of a monitor: time, pose and wrench of every tick.
template <class Pose, class Wrench>
vibration_monitor watch(double rate_hz, double seconds, Pose T_dh, Wrench on_hand) {
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 / rate_hz));
  vibration_monitor m(period_ns);
  const auto ticks = static_cast<std::int64_t>(seconds * rate_hz);
  for (std::int64_t i = 0; i < ticks; ++i) {
    const double t = 1e-9 * static_cast<double>(i * period_ns);
    m.observe(i * period_ns, T_dh(t), on_hand(t));
  }
  return m;
}

pose still(double) { return {quat(1.0, 0.0, 0.0, 0.0), vec3(0.1, -0.2, 0.05)}; }

TEST(vibration_monitor, reads_sines_as_the_closed_form_has_them) {
  const std::uint64_t seed = fresh_seed("vibration", "6 frequencies at 7 usual rates and 5 drawn ones");
  numbers drawn(seed_of(seed, "rates"));
  std::vector<double> rates(std::begin(usual_rates_hz), std::end(usual_rates_hz));
  for (int i = 0; i < 5; ++i) rates.push_back(200.0 * std::pow(50.0, drawn(0.0, 1.0)));
  double worst = 0.0;
  for (const double wanted_hz : rates) {
    const double rate = 1e9 / static_cast<double>(std::llround(1e9 / wanted_hz));
    if (rate > 10000.0 || rate < 200.0) continue;
    for (const double f : {20.0, 59.0, 61.0, 100.0, 230.0, 400.0}) {
      if (f > 0.45 * rate) continue;
      numbers random(seed_of(seed, "sine", static_cast<std::uint64_t>(f * rate)));
      const double force = std::exp(random(-6.0, 2.0)), torque = std::exp(random(-10.0, -1.0));
      const double phase = random(0.0, 6.0);
      const vec3 mean_f = 3.0 * random.direction(), mean_t = 0.1 * random.direction();
      const vec3 along_f = random.direction(), along_t = random.direction();
      const double through = share(f, rate) / std::numbers::sqrt2, noise = 0.05 * through;
      const auto m = watch(rate, 3.0, still, [&](double t) {
        const double s = std::sin(2.0 * pi * f * t + phase);
        const auto rough = [&] { return noise * vec3(random.normal(), random.normal(), random.normal()); };
        const vec3 rough_f = rough(), rough_t = rough();
        return wrench{mean_f + force * (s * along_f + rough_f), mean_t + torque * (s * along_t + rough_t)};
      });
      const double expected = std::sqrt(through * through + 3.0 * noise * noise * std::pow(noise_share(rate), 2.0));
      const vibration_report& r = m.report();
      SCOPED_TRACE(testing::Message() << f << " Hz at " << rate << " Hz");
      EXPECT_NEAR(r.force.rms, force * expected, 0.02 * force * expected);
      EXPECT_NEAR(r.torque.rms, torque * expected, 0.02 * torque * expected);
      EXPECT_NEAR(r.force.mean, 3.0, 0.02 + 0.02 * force);
      EXPECT_NEAR(r.torque.mean, 0.1, 0.001 + 0.02 * torque);
      EXPECT_EQ(r.force.excessive, r.force.worst_rms > std::max(0.01 * r.force.worst_mean, 5e-3));
      worst = std::max(worst, std::fabs(r.force.rms / (force * expected) - 1.0));
    }
  }
  std::printf("  force read within %.2f %%\n", 100.0 * worst);
}

TEST(vibration_monitor, knows_its_rates) {
  for (const double rate : usual_rates_hz) {
    EXPECT_TRUE(vibration_monitor(static_cast<std::int64_t>(1e9 / rate)).valid()) << rate;
  }
  for (const std::int64_t period_ns : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{99'999}, std::int64_t{5'000'001},
                                       std::numeric_limits<std::int64_t>::max()}) {
    vibration_monitor m(period_ns);
    EXPECT_FALSE(m.valid());
    for (std::int64_t i = 0; i < 5000; ++i)
      m.observe(i * 1'000'000, still(0.0), {vec3(static_cast<double>(i % 2)), vec3(0.0)});
    EXPECT_EQ(m.report().measurements, 0U);
  }
}

TEST(vibration_monitor, a_step_and_what_a_moving_hand_does_are_no_vibration) {
  const std::uint64_t seed = fresh_seed("vibration_steps", "7 rates");
  for (const double rate : usual_rates_hz) {
    numbers random(seed_of(seed, "step", static_cast<std::uint64_t>(rate)));
    const double at = random(0.5, 2.5), size = random(0.5, 5.0);
    const vibration_report step = watch(rate, 4.0, still, [&](double t) {
                                    return wrench{vec3(0.0, 0.0, t < at ? 1.0 : 1.0 + size), vec3(0.0)};
                                  }).report();
    EXPECT_GT(step.measurements, 20U);
    EXPECT_LT(step.force.worst_rms, 1e-4) << rate;
    EXPECT_FALSE(step.force.excessive);

    // A slow swing of the force, the hand at rest.
    const vibration_report swing = watch(rate, 4.0, still, [&](double t) {
                                     return wrench{vec3(2.0 * std::sin(2.0 * pi * 2.0 * t), 0.0, 3.0), vec3(0.0)};
                                   }).report();
    EXPECT_LT(swing.force.worst_rms, 1e-4) << rate;

    // The hand moves over a rough surface: what it feels is its own doing.
    const vec3 way = random.direction();
    const auto moves = [&](double t) { return pose{quat(1.0, 0.0, 0.0, 0.0), 0.05 * t * way}; };
    const auto turns = [&](double t) { return pose{exp_rotation(0.2 * t * way), vec3(0.0)}; };
    const auto rough = [&](double t) { return wrench{vec3(std::sin(2.0 * pi * 80.0 * t)), vec3(0.0)}; };
    EXPECT_EQ(watch(rate, 3.0, moves, rough).report().measurements, 0U);
    EXPECT_EQ(watch(rate, 3.0, turns, rough).report().measurements, 0U);
    // A handle that vibrates on the spot rests, and so does one that creeps.
    const auto shakes = [&](double t) {
      return pose{exp_rotation(5e-3 * std::sin(2.0 * pi * 83.0 * t) * way), 5e-4 * std::sin(2.0 * pi * 83.0 * t) * way};
    };
    EXPECT_GT(watch(rate, 3.0, shakes, rough).report().force.rms, 0.5);
    const auto creeps = [&](double t) { return pose{quat(1.0, 0.0, 0.0, 0.0), 1e-3 * t * way}; };
    EXPECT_GT(watch(rate, 3.0, creeps, rough).report().force.rms, 0.5);
  }
}

TEST(vibration_monitor, reports_the_worst_and_when) {
  const auto burst = [](double t) {
    const double size = t > 4.0 && t < 6.0 ? 0.1 : 0.01;
    return wrench{vec3(0.0, 0.0, 2.0 + size * std::sin(2.0 * pi * 230.0 * t)), vec3(0.0)};
  };
  const vibration_report r = watch(1000.0, 10.0, still, burst).report();
  const double through = share(230.0, 1000.0) / std::numbers::sqrt2;
  EXPECT_NEAR(r.force.worst_rms, 0.1 * through, 0.002 * through);
  EXPECT_GE(r.force.worst_time_ns, 4'700'000'000);
  EXPECT_LE(r.force.worst_time_ns, 6'300'000'000);
  EXPECT_NEAR(r.force.rms, 0.01 * through, 2e-4 * through);
  EXPECT_TRUE(r.force.excessive);  // for the worst: 70 mN of 2 N
  EXPECT_FALSE(r.torque.excessive);
  EXPECT_NEAR(1e-9 * static_cast<double>(r.rest_ns), 9.9, 0.01);
}

TEST(vibration_monitor, starts_anew_after_a_gap_and_what_is_not_a_number) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), huge = 1e200;
  const wrench bad_wrenches[] = {{vec3(nan, 0.0, 0.0), vec3(0.0)},
                                 {vec3(0.0), vec3(0.0, 0.0, std::numeric_limits<double>::infinity())},
                                 {vec3(huge), vec3(0.0)}};
  for (const wrench& bad : bad_wrenches) {
    vibration_monitor m(1'000'000);
    std::int64_t now = 0;
    const auto go = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) m.observe(now += 1'000'000, still(0.0), {vec3(0.0, 0.0, 1.0), vec3(0.0)});
    };
    go(2000);
    m.observe(now += 1'000'000, still(0.0), bad);
    go(2000);
    m.observe(now += 1'000'000, {quat(nan, 0.0, 0.0, 0.0), vec3(0.0)}, {});
    go(2000);
    EXPECT_GT(m.report().measurements, 35U);  // each of the three stretches has 13
    EXPECT_EQ(m.report().force.worst_rms, 0.0);
    EXPECT_EQ(m.report().force.rms, 0.0);
    EXPECT_NEAR(m.report().force.mean, 1.0, 1e-12);
  }
  // Ticks that are missing: a sine of which every other tenth of a second is cut out is no step.
  vibration_monitor m(1'000'000);
  std::int64_t now = 0;
  for (int part = 0; part < 20; ++part) {
    now += part % 2 == 0 ? 50'000'000 : -7'000'000;
    for (int i = 0; i < 300; ++i) m.observe(now += 1'000'000, still(0.0), {vec3(part), vec3(0.0)});
  }
  EXPECT_EQ(m.report().measurements, 0U);
}

TEST(vibration_monitor, does_nothing_that_a_tick_must_not_do) {
  vibration_monitor m(1'000'000);
  test_support::tick_trap trap;
  trap([&] {
    for (std::int64_t i = 0; i < 3000; ++i)
      m.observe(i * 1'000'000, still(0.0), {vec3(static_cast<double>(i % 3)), vec3(0.0)});
  });
  EXPECT_GT(m.report().measurements, 10U);
}

}  // namespace
}  // namespace asperity
