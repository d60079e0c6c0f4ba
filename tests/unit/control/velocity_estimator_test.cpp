// How fast a handle moves: by its last poses, or as a device tells it where that can be believed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

#include <asperity/device/sample_check.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using test_support::drawn;
using test_support::fresh_seed;
using test_support::seed_of;

constexpr double step_m = 1e-5;
constexpr double step_rad = 1e-4;
constexpr sample_field all_fields =
    sample_field::position | sample_field::rotation | sample_field::linear_velocity | sample_field::angular_velocity;

double rounded(double x, double step) { return step * std::round(x / step); }

/// What an encoder makes of a motion, sample by sample.
struct encoder {
  velocity_estimator speed;
  std::uint64_t sequence = 0;
  void see(double t_s, const vec3& x_m, const vec3& turn_rad, const twist& told, sample_field valid = all_fields) {
    device_sample s;
    s.host_time_ns = std::llround(1e9 * t_s);
    s.sequence = ++sequence;
    for (int i = 0; i < 3; ++i) s.T_dh.position[i] = rounded(x_m[i], step_m);
    vec3 turn = turn_rad;
    for (int i = 0; i < 3; ++i) turn[i] = rounded(turn[i], step_rad);
    s.T_dh.rotation = exp_rotation(turn);
    s.velocity_d = told;
    s.valid = valid;
    speed.observe(s);
  }
};

encoder by_window() { return {velocity_estimator(velocity_source::window, step_m, step_rad)}; }
encoder by_device() { return {velocity_estimator(velocity_source::device, step_m, step_rad)}; }

TEST(velocity_estimator, of_an_even_motion_is_exact_within_a_step_over_the_window) {
  drawn d(seed_of(fresh_seed("velocity_estimator", "200 even motions"), "even"));
  for (int i = 0; i < 200; ++i) {
    encoder e = by_window();
    const double rate_hz = d.log_between(200.0, 10'000.0);
    const vec3 v = d.inside(0.5), w = d.inside(5.0);
    const vec3 from = d.inside(0.1);
    // The rotation is about one axis, so that its vector grows evenly.
    for (int k = 0; k <= static_cast<int>(0.05 * rate_hz); ++k) {
      const double t = k / rate_hz;
      e.see(t, from + t * v, t * w, {});
    }
    // A line that fits many points is off by far less than a step over its length.
    EXPECT_LT(glm::length(e.speed.velocity_d().linear - v), 2.0 * step_m / 0.016) << rate_hz;
    EXPECT_LT(glm::length(e.speed.velocity_d().angular - w), 2.0 * step_rad / 0.016) << rate_hz;
    EXPECT_EQ(e.speed.used(), velocity_source::window);
  }
}

TEST(velocity_estimator, of_a_stop_is_nothing_soon) {
  for (const double rate_hz : {200.0, 1000.0, 4000.0, 10'000.0}) {
    encoder e = by_window();
    const double v = 0.2, period_s = 1.0 / rate_hz;
    double t = 0.0;
    for (; t < 0.05; t += period_s) e.see(t, {v * t, 0, 0}, vec3(0.0), {});
    const double stopped_s = t, at = v * t;
    EXPECT_NEAR(e.speed.velocity_d().linear.x, v, 0.01);
    while (std::fabs(e.speed.velocity_d().linear.x) > 0.01 && t < stopped_s + 0.05) {
      t += period_s;
      e.see(t, {at, 0, 0}, vec3(0.0), {});
    }
    // Two poses on the spot, where a window of 20 ms would take ten times as long.
    EXPECT_LE(t - stopped_s, std::max(2.1 * period_s, 2.6e-3)) << rate_hz;
  }
}

TEST(velocity_estimator, of_a_slow_motion_is_nearer_the_truth_than_two_poses_are) {
  drawn d(seed_of(fresh_seed("handle_velocity_any", "60 motions"), "any"));
  for (int i = 0; i < 60; ++i) {
    encoder e = by_window();
    const double rate_hz = d.log_between(500.0, 10'000.0), period_s = 1.0 / rate_hz;
    const double swing = 6.283 * d.between(0.3, 3.0), amplitude = d.log_between(1e-4, 0.02) / swing;
    double by_poses = 0.0, by_line = 0.0, before = 0.0;
    for (int k = 0; k < static_cast<int>(rate_hz); ++k) {
      const double t = k * period_s;
      const double x = amplitude * std::sin(swing * t), v = amplitude * swing * std::cos(swing * t);
      e.see(t, {x, 0, 0}, vec3(0.0), {});
      const double two = (rounded(x, step_m) - before) / period_s;
      before = rounded(x, step_m);
      if (k < 2) continue;
      by_poses += (two - v) * (two - v);
      by_line += (e.speed.velocity_d().linear.x - v) * (e.speed.velocity_d().linear.x - v);
    }
    EXPECT_LT(by_line, by_poses) << rate_hz << ' ' << amplitude;
  }
}

TEST(velocity_estimator, takes_what_the_device_tells) {
  encoder e = by_device();
  for (int k = 0; k < 100; ++k) e.see(1e-3 * k, {1e-4 * k, 0, 0}, {0, 1e-3 * k, 0}, {{0.1, 0, 0}, {0, 1.0, 0}});
  EXPECT_EQ(e.speed.velocity_d().linear, vec3(0.1, 0, 0));
  EXPECT_EQ(e.speed.velocity_d().angular, vec3(0, 1.0, 0));
  EXPECT_EQ(e.speed.used(), velocity_source::device);
  EXPECT_FALSE(e.speed.refused());
}

TEST(velocity_estimator, takes_the_window_where_the_device_tells_none) {
  encoder none = by_device(), linear_alone = by_device(), window = by_window();
  for (int k = 0; k < 100; ++k) {
    const twist lie{{9, 9, 9}, {9, 9, 9}};
    const double x = 1e-3 * std::sin(0.1 * k);
    none.see(1e-3 * k, {x, 0, 0}, {0, x, 0}, lie, sample_field::position | sample_field::rotation);
    window.see(1e-3 * k, {x, 0, 0}, {0, x, 0}, lie);
    linear_alone.see(1e-3 * k, {x, 0, 0}, {0, x, 0}, {{0.1 * std::cos(0.1 * k), 0, 0}, {9, 9, 9}},
                     sample_field::position | sample_field::linear_velocity);
  }
  EXPECT_EQ(none.speed.used(), velocity_source::window);
  EXPECT_FALSE(none.speed.refused());
  EXPECT_EQ(none.speed.velocity_d().linear, window.speed.velocity_d().linear);
  EXPECT_EQ(linear_alone.speed.used(), velocity_source::device);
  EXPECT_EQ(linear_alone.speed.velocity_d().angular, window.speed.velocity_d().angular);
}

TEST(velocity_estimator, believes_no_device_whose_velocity_does_not_go_with_its_poses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double factor : {-1.0, 0.0, 2.0, 1000.0, nan, infinite}) {
    for (const bool turns : {false, true}) {
      encoder e = by_device();
      const double amplitude = turns ? 0.5 : 0.03, swing = 6.283;  // a hand's, once a second
      double worst = 0.0;
      for (int k = 0; k < 2000; ++k) {
        const double t = 1e-3 * k;
        const double x = amplitude * std::sin(swing * t), v = amplitude * swing * std::cos(swing * t);
        const double told = factor * v;
        const vec3 zero(0.0);
        e.see(t, turns ? zero : vec3(x, 0, 0), turns ? vec3(x, 0, 0) : zero,
              turns ? twist{zero, {told, 0, 0}} : twist{{told, 0, 0}, zero});
        const vec3 given = turns ? e.speed.velocity_d().angular : e.speed.velocity_d().linear;
        EXPECT_TRUE(is_finite(given));
        if (k > 500) worst = std::max(worst, std::fabs(given.x - v) / (amplitude * swing));
      }
      EXPECT_TRUE(e.speed.refused()) << factor << turns;
      EXPECT_LT(worst, 0.3) << factor << turns;
      e.speed.restart();
      EXPECT_FALSE(e.speed.refused());
    }
  }
}

TEST(velocity_estimator, believes_a_device_that_is_late_and_noisy) {
  drawn d(seed_of(fresh_seed("handle_velocity_late", "40 motions"), "late"));
  for (int i = 0; i < 40; ++i) {
    encoder e = by_device();
    const double late_s = d.between(0.0, 0.01), amplitude = d.log_between(1e-4, 0.05);
    const double swing = 6.283 * d.between(0.3, 4.0), noise = d.between(0.0, 0.05);
    for (int k = 0; k < 4000; ++k) {
      const double t = 1e-3 * k;
      const double v = amplitude * swing * std::cos(swing * (t - late_s)) + noise * d.between(-1.0, 1.0);
      e.see(t, {amplitude * std::sin(swing * t), 0, 0}, vec3(0.0), {{v, 0, 0}, vec3(0.0)});
    }
    EXPECT_FALSE(e.speed.refused()) << late_s << ' ' << amplitude << ' ' << swing;
  }
}

TEST(velocity_estimator, of_old_poses_stays) {
  encoder e = by_window();
  for (int k = 0; k < 50; ++k) e.see(1e-3 * k, {1e-4 * k, 0, 0}, vec3(0.0), {});
  const twist before = e.speed.velocity_d();
  --e.sequence;  // the same sample again
  e.see(0.049, {1e-4 * 49, 0, 0}, vec3(0.0), {});
  e.see(0.049, {1e-4 * 50, 0, 0}, vec3(0.0), {});  // another one of the same time
  EXPECT_EQ(e.speed.velocity_d().linear, before.linear);
}

TEST(velocity_estimator, of_poses_is_none) {
  encoder e{velocity_estimator{}};
  for (int k = 0; k < 50; ++k) e.see(1e-3 * k, {1e-4 * k, 0, 0}, vec3(0.0), {{0.1, 0, 0}, vec3(0.0)});
  EXPECT_EQ(e.speed.used(), velocity_source::poses);
  EXPECT_EQ(e.speed.velocity_d().linear, vec3(0.0));
}

}  // namespace
