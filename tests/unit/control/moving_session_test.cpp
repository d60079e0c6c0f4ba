// Bodies that move under the probe: followed between what an application tells, felt where they are, paid for by them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include <asperity/control/carried_contact.hpp>
#include <asperity/control/moving_bodies.hpp>
#include <asperity/control/virtual_tool.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double most_surplus_j = 1e-5;  // the guard's tolerance: rounding and the encoder's steps

/// A body that swings about a place in all six directions, or goes on at a velocity.
struct swing {
  pose about{};
  vec3 goes_m_per_s{0.0};
  vec3 way_m{0.0}, turn_rad{0.0};  // amplitudes
  double rate_rad_per_s = 0.0, begins_s = 0.2;

  // Begins without a jerk.
  [[nodiscard]] double grown(double t_s) const { return smoothstep((t_s - begins_s) / 0.2); }
  [[nodiscard]] pose at(double t_s) const {
    const double x = grown(t_s) * std::sin(rate_rad_per_s * (t_s - begins_s));
    return {glm::normalize(exp_rotation(x * turn_rad) * about.rotation),
            about.position + x * way_m + std::max(0.0, t_s - begins_s) * grown(t_s) * goes_m_per_s};
  }
  [[nodiscard]] body_motion told_at(double t_s) const {
    constexpr double h = 1e-6;
    const pose a = at(t_s - h), b = at(t_s + h);
    return {0,
            at(t_s),
            {(b.position - a.position) / (2.0 * h), log_rotation(b.rotation * glm::conjugate(a.rotation)) / (2.0 * h)}};
  }
};

/// A body of planes that is where the pose of the scene puts it: rendered in its own frame.
struct placed_planes {
  plane_body body{};
  const pose* unseen = nullptr;  // where it is where the session does not know that it moves
  std::vector<support_plane> planes{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const pose T_wb = unseen != nullptr ? *unseen : at.T_wb[0];
    const pose T_ba = inverse(T_wb) * at.T_wa;
    const status s = body.step({T_ba, {}, at.gaps_m}, out);
    const quat& r = T_wb.rotation;
    planes.assign(out.planes.begin(), out.planes.end());
    for (support_plane& p : planes) {
      p.gradient = {r * p.gradient.linear, r * p.gradient.angular};
      p.n_ab_w = r * p.n_ab_w;
      p.r_w = r * p.r_w;
    }
    out.planes = planes;
    out.force = {};
    out.centre_of_mass_w = at.T_wa.position;
    return s;
  }
};

struct moving_case {
  plane_body body{};
  swing motion{};
  simulated_settings hand{};
  control_settings control{};
  virtual_schedule schedule{};
  double told_every_s = 0.0;  // 0: before every device tick
  bool is_told = true;        // false: the planes move, and nobody tells the session
  double length_s = 1.0, settled_s = 0.6;
};

struct moving_outcome {
  double deepest_m = 0.0;
  double surplus_j = 0.0;  // most that the hand received beyond what it had lent and what the body gave
  double delivered_j = 0.0, from_bodies_j = 0.0, paid_j = 0.0;  // the last: by what the body felt and its true velocity
  double guard_scale = 1.0;
  std::uint64_t not_ok = 0, lost = 0;
  vec3 force_n{0.0}, on_body_n{0.0};
  std::vector<vec3> force_each_ms;  // settled
};

moving_outcome run(const moving_case& c) {
  struct watch {
    session_record last;
    void operator()(const session_record& r) noexcept { last = r; }
  };
  simulated_device dev(c.hand);
  moving_outcome out;
  EXPECT_TRUE(dev.open() && dev.arm());
  pose truth = c.motion.at(0.0);
  placed_planes renderer{.body = c.body};
  if (!c.is_told) renderer.unseen = &truth;
  virtual_session<placed_planes, simulated_device, watch> session(renderer, {{truth}, vec3(0.0)}, dev, c.control,
                                                                  c.schedule);
  const double period_s = 1e-9 * static_cast<double>(c.schedule.device_period_ns);
  double told_s = -1e9, surplus = 0.0, before = 0.0, settled = 0.0;
  for (;;) {
    const double now_s = 1e-9 * static_cast<double>(session.now_ns());
    if (now_s >= c.length_s) break;
    truth = c.motion.at(now_s);
    if (c.is_told && now_s - told_s >= c.told_every_s - 1e-9) {
      moving_bodies told;
      told.time_ns = session.now_ns();
      static_cast<void>(told.list.push_back(c.motion.told_at(now_s)));
      session.move_bodies(told);
      told_s = now_s;
    }
    if (session.step() != status::ok) ++out.not_ok;
    const session_record& r = session.device().observer().last;
    if (has(r.flags, tick_flag::body_lost)) ++out.lost;
    const wrench on_body = session.felt().on(0);
    // The body's mean motion in the period that the tick went through, about the point of the wrench.
    const pose was = c.motion.at(now_s - period_s);
    const vec3 turned = log_rotation(truth.rotation * glm::conjugate(was.rotation));
    const vec3 middle = 0.5 * (truth.position + was.position);
    const vec3 moved = truth.position - was.position + glm::cross(turned, session.felt().point_w - middle);
    out.paid_j -= glm::dot(on_body.force, moved) + glm::dot(on_body.torque, turned);
    // In the body where the session takes it to be: between two poses that are told it guesses.
    const body_places& places = session.device().bodies().places();
    const pose& T_wb = places.empty() ? truth : places[0].T_wb;
    out.deepest_m = std::max(out.deepest_m, c.body.depth_m(inverse(T_wb) * r.T_wa));
    out.guard_scale = std::min(out.guard_scale, r.guard_scale);
    const double delivered = dev.delivered_j() - r.from_bodies_j;
    surplus = std::max(-0.1, surplus + delivered - before);
    before = delivered;
    out.surplus_j = std::max(out.surplus_j, surplus);
    if (now_s < c.settled_s) continue;
    settled += 1.0;
    out.force_n += r.on_hand_d.force;
    out.on_body_n += on_body.force;
    if (r.time_ns % 1'000'000 == 0) out.force_each_ms.push_back(r.on_hand_d.force);
  }
  out.delivered_j = dev.delivered_j();
  out.from_bodies_j = session.device().observer().last.from_bodies_j;
  if (settled > 0.0) {
    out.force_n /= settled;
    out.on_body_n /= settled;
  }
  return out;
}

moving_case pressed(double newtons, double device_hz, double contact_hz) {
  moving_case c;
  c.body = block_on_plane();
  c.control.guard.enabled = false;
  c.hand = hand_that_presses(newtons, {0, 0, 0.01}, {0, 0, -1}, 500.0);
  c.schedule = {.device_period_ns = static_cast<std::int64_t>(1e9 / device_hz),
                .contact_period_ns = static_cast<std::int64_t>(1e9 / contact_hz),
                .contact_one_period_late = true};
  return c;
}

// A plane of a body that moves has the depth that the pair has in its new pose: computed here in the body's own frame.
TEST(carried_contact, is_exact_for_planes) {
  drawn d(seed_of(fresh_seed("carried_contact.is_exact_for_planes", "2000 planes"), "planes"));
  for (int i = 0; i < 2000; ++i) {
    const auto any_pose = [&] { return pose{exp_rotation(d.inside(2.0)), d.inside(0.2)}; };
    const pose T_wa = any_pose(), then_T_wb = any_pose();
    const double far = d.log_between(1e-6, 1e-2);
    const pose X{exp_rotation(d.inside(100.0 * far)), d.inside(far)};
    const pose now_T_wb = X * then_T_wb;
    const vec3 point_a = d.inside(0.02), normal_b = d.direction();
    const double height_m = glm::dot(normal_b, inverse(then_T_wb) * (T_wa * point_a)) + d.between(-1e-3, 1e-3);
    const vec3 r = T_wa * point_a - T_wa.position, slope = -(then_T_wb.rotation * normal_b);
    linear_contact contact;
    contact.T_wc = T_wa;
    const double depth_then = height_m - glm::dot(normal_b, inverse(then_T_wb) * (T_wa * point_a));
    static_cast<void>(contact.planes.push_back(
        {.depth_m = depth_then, .gradient = {slope, glm::cross(r, slope)}, .n_ab_w = slope, .r_w = r, .body = 3}));
    static_cast<void>(contact.planes.push_back(contact.planes[0]));
    contact.planes[1].body = 4;
    static_cast<void>(contact.bodies.push_back({3, then_T_wb}));
    const double dt_s = d.log_between(1e-4, 1e-2);
    const vec6 way{d.inside(1e-3), d.inside(1e-2)};
    // The way ends at now_T_wb, and the step begins at its end.
    const body_way gone{
        3, {glm::conjugate(exp_rotation(way.angular)) * now_T_wb.rotation, now_T_wb.position - way.linear}, way};
    support_planes carried;
    body_velocities velocities;
    const std::array<body_way, 1> ways{gone};
    carried_contact(contact, contact.planes, ways).at(T_wa, 1.0, dt_s, carried, velocities);
    const auto depth_at = [&](const pose& T_wb) {
      return height_m - glm::dot(normal_b, inverse(T_wb) * (T_wa * point_a));
    };
    // The probe has not moved: what the plane says there is its depth. Turning a point by a linearised rotation is wrong
    // to the second order of the angle.
    const double second = glm::length(r) * std::pow(100.0 * far, 2.0);
    EXPECT_NEAR(carried[0].depth_m, depth_at(now_T_wb), 1e-12 + second) << i;
    EXPECT_NEAR(glm::dot(carried[0].n_ab_w, -(now_T_wb.rotation * normal_b)), 1.0, 1e-12);
    constexpr double h = 1e-6;
    const auto later = [&](double s) {
      return pose{exp_rotation(s / dt_s * way.angular) * now_T_wb.rotation, now_T_wb.position + s / dt_s * way.linear};
    };
    const double closing = (depth_at(later(h)) - depth_at(later(-h))) / (2.0 * h);
    EXPECT_NEAR(carried[0].closing_m_per_s, closing, 1e-6 + 0.1 * glm::length(way.angular) / dt_s * 100.0 * far) << i;
    EXPECT_EQ(carried[1].depth_m, depth_then);
    EXPECT_EQ(carried[1].closing_m_per_s, 0.0);
  }
}

// What is told unevenly and late is followed without a step, and exactly where the velocity holds.
TEST(body_follower, makes_no_step) {
  drawn d(seed_of(fresh_seed("body_follower.makes_no_step", "60 bodies"), "bodies"));
  for (int i = 0; i < 60; ++i) {
    const bool steady = i % 3 == 0;
    swing motion{.about = {exp_rotation(d.inside(1.0)), d.inside(0.3)}, .begins_s = -1.0};
    motion.goes_m_per_s = d.inside(0.3);
    if (!steady) motion.way_m = d.inside(0.05), motion.turn_rad = d.inside(0.3);
    motion.rate_rad_per_s = d.between(1.0, 10.0);
    body_follower follows;
    const std::int64_t period_ns = static_cast<std::int64_t>(1e9 / d.log_between(200.0, 10'000.0));
    std::int64_t next_told_ns = 0;
    pose last{};
    double worst_m = 0.0, quickest_m = 0.0, off_m = 0.0;
    for (std::int64_t now_ns = 0; now_ns < 500'000'000; now_ns += period_ns) {
      if (now_ns >= next_told_ns) {
        moving_bodies told;
        told.time_ns = now_ns - static_cast<std::int64_t>(d.between(0.0, 3e6));
        body_motion m = motion.told_at(1e-9 * static_cast<double>(told.time_ns));
        m.body = 7;
        static_cast<void>(told.list.push_back(m));
        follows.take(told, now_ns);
        next_told_ns = now_ns + static_cast<std::int64_t>(d.between(1e6, 3e7));
      }
      follows.advance(now_ns);
      ASSERT_EQ(follows.places().size(), 1U);
      const pose truth = motion.at(1e-9 * static_cast<double>(now_ns));
      const pose& is = follows.places()[0].T_wb;
      EXPECT_TRUE(is_valid(is));
      EXPECT_FALSE(follows.refused() || follows.is_lost());
      if (now_ns > 0) {
        const pose before = motion.at(1e-9 * static_cast<double>(now_ns - period_ns));
        worst_m = std::max(worst_m, glm::length(is.position - last.position));
        quickest_m = std::max(quickest_m, glm::length(truth.position - before.position));
        EXPECT_LT(glm::length(follows.ways()[0].after(1.0).position - is.position), 1e-15);
      }
      off_m = std::max(off_m, glm::length(is.position - truth.position));
      last = is;
    }
    if (steady) {
      EXPECT_LT(off_m, 1e-9) << i;
    } else {
      // A guess over 33 ms is off by half the acceleration times the square of it, made up for in a millisecond or more.
      const double acceleration = glm::length(motion.way_m) * motion.rate_rad_per_s * motion.rate_rad_per_s;
      EXPECT_LT(off_m, acceleration * 0.033 * 0.033 + 1e-6) << i;
      EXPECT_LT(worst_m,
                quickest_m + acceleration * 0.033 * 0.033 * std::min(1.0, 1e-6 * static_cast<double>(period_ns)) + 1e-6)
          << i;
    }
  }
}

TEST(body_follower, stands_still_without_news_and_refuses_what_is_no_motion) {
  body_follower follows;
  moving_bodies told;
  body_motion m{.body = 2, .T_wb = {}, .velocity_w = {{0.5, 0, 0}, {0, 0, 0}}};
  static_cast<void>(told.list.push_back(m));
  follows.take(told, 0);
  follows.advance(0);
  follows.advance(99'000'000);
  EXPECT_NEAR(follows.places()[0].T_wb.position.x, 0.0495, 1e-12);
  EXPECT_FALSE(follows.is_lost());
  follows.advance(300'000'000);
  EXPECT_NEAR(follows.places()[0].T_wb.position.x, 0.05, 1e-12);
  EXPECT_TRUE(follows.is_lost());
  const auto refuse = [&](const body_motion& bad) {
    moving_bodies list;
    list.time_ns = 300'000'000;
    static_cast<void>(list.list.push_back(bad));
    follows.take(list, 300'000'000);
    follows.advance(300'000'000);
    EXPECT_TRUE(follows.refused());
    EXPECT_NEAR(follows.places()[0].T_wb.position.x, 0.05, 1e-12);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuse({.body = 2, .T_wb = {quat(1, 0, 0, 0), {nan, 0, 0}}});
  refuse({.body = 2, .T_wb = {quat(0.5, 0, 0, 0), {0, 0, 0}}});
  refuse({.body = 2, .T_wb = {}, .velocity_w = {{0, nan, 0}, {}}});
  refuse({.body = 2, .T_wb = {}, .velocity_w = {{0, 0, 1e3}, {}}});
  // Put elsewhere: it is there at once, and goes no way.
  moving_bodies far;
  far.time_ns = 301'000'000;
  static_cast<void>(far.list.push_back({.body = 2, .T_wb = {quat(1, 0, 0, 0), {1, 0, 0}}}));
  follows.take(far, 301'000'000);
  follows.advance(301'000'000);
  EXPECT_EQ(follows.places()[0].T_wb.position.x, 1.0);
  EXPECT_EQ(follows.ways()[0].way.linear, vec3(0.0));
  // One body too many.
  for (std::uint32_t b = 10; b < 10 + most_moving_bodies; ++b) {
    moving_bodies more;
    static_cast<void>(more.list.push_back({.body = b}));
    follows.take(more, 302'000'000);
    EXPECT_EQ(follows.refused(), b == 10 + most_moving_bodies - 1) << b;
  }
}

// A hand rests on a plane that swings, contacts at 200 Hz and a period late. The reference hears of everything at once.
TEST(moving_session, feels_a_swinging_plane) {
  drawn d(seed_of(fresh_seed("moving_session.feels_a_swinging_plane", "6 swings, 40 at length"), "swings"));
  const int each = extent(6, 40);
  double worst = 0.0, worst_untold = 0.0;
  for (int i = 0; i < each; ++i) {
    swing motion;
    motion.way_m = {d.between(-0.002, 0.002), d.between(-0.002, 0.002), d.between(0.001, 0.004)};
    motion.turn_rad = {d.between(-0.02, 0.02), d.between(-0.02, 0.02), d.between(-0.1, 0.1)};
    motion.rate_rad_per_s = 6.283 * d.between(0.5, 2.0);
    const auto felt = [&](double device_hz, double contact_hz, bool late, bool told, double every_s) {
      moving_case c = pressed(6.0, device_hz, contact_hz);
      c.schedule.contact_one_period_late = late;
      c.motion = motion;
      c.is_told = told;
      c.told_every_s = every_s;
      const moving_outcome o = run(c);
      EXPECT_EQ(o.not_ok, 0U);
      EXPECT_EQ(o.lost, 0U);
      return o;
    };
    const moving_outcome reference = felt(1000, 1000, false, true, 0.0);
    const double off = rms_difference(felt(1000, 200, true, true, 0.0).force_each_ms, reference.force_each_ms);
    const double seldom = rms_difference(felt(1000, 200, true, true, 0.02).force_each_ms, reference.force_each_ms);
    const double untold = rms_difference(felt(1000, 200, true, false, 0.0).force_each_ms, reference.force_each_ms);
    worst = std::max({worst, off, seldom});
    worst_untold = std::max(worst_untold, untold);
  }
  std::printf("  off by %.4f N rms; %.3f where nobody tells the session\n", worst, worst_untold);
  EXPECT_LE(worst, 0.05);
  EXPECT_GT(worst_untold, 0.05);
}

// A block that is pressed on a belt is dragged with mu N, and drags at the belt as much.
TEST(moving_session, is_dragged_by_a_conveyor) {
  drawn d(seed_of(fresh_seed("moving_session.is_dragged_by_a_conveyor", "12 belts"), "belts"));
  for (int i = 0; i < 12; ++i) {
    const double mu = i % 4 == 0 ? 0.0 : d.between(0.1, 0.6);
    moving_case c = pressed(d.between(2.0, 10.0), i % 2 == 0 ? 1000 : 4000, i % 3 == 0 ? 200 : 1000);
    const double heading = d.between(0.0, 6.283), speed = d.between(0.1, 0.4);
    c.motion.goes_m_per_s = speed * vec3(std::cos(heading), std::sin(heading), 0.0);
    c.control.friction = {.static_coefficient = mu, .dynamic_coefficient = mu};
    c.length_s = 1.6;
    c.settled_s = 1.2;
    const moving_outcome o = run(c);
    EXPECT_EQ(o.not_ok, 0U);
    const double along = glm::dot(o.force_n, glm::normalize(c.motion.goes_m_per_s));
    EXPECT_GT(o.force_n.z, 1.0);
    EXPECT_NEAR(along / o.force_n.z, mu, 0.01 * mu + 1e-3) << i;
    EXPECT_LT(glm::length(o.force_n + o.on_body_n), 0.01 * o.force_n.z) << i;
    EXPECT_NEAR(o.from_bodies_j, o.paid_j, 1e-3 * std::fabs(o.paid_j) + 1e-6) << i;
    EXPECT_LE(o.deepest_m, 1e-4) << i;
  }
}

// Hands press, scrub and tap on bodies that swing; what they receive, they or the bodies have given.
TEST(moving_session, holds_and_makes_no_energy) {
  drawn d(seed_of(fresh_seed("moving_session.holds_and_makes_no_energy", "24 sessions, 240 at length"), "moving"));
  struct rates {
    double device_hz, contact_hz;
  };
  constexpr std::array<rates, 4> moved_at{{{10'000, 10'000}, {4000, 1000}, {1000, 1000}, {200, 200}}};
  double deepest_fast = 0.0, deepest_slow = 0.0, surplus = 0.0, apart = 0.0;
  const int each = extent(1, 10);
  for (const rates& r : moved_at) {
    for (int kind = 0; kind < hand_kinds; ++kind) {
      for (int n = 0; n < 2 * each; ++n) {
        moving_case c = pressed(5.0, r.device_hz, r.contact_hz);
        c.body = n % 2 == 0 ? block_on_plane() : block_on_plate(0.001);
        c.control.coupling = coupling_for(simulated_capabilities(), r.device_hz);
        const double mu = n % 3 == 0 ? 0.0 : d.between(0.1, 1.0);
        c.control.friction = {.static_coefficient = mu, .dynamic_coefficient = mu * d.between(0.5, 1.0)};
        draw_hand(c.hand, kind, d);
        // Towards the hand by little: what a coupling holds beyond 0.1 J, nobody counts as lent.
        c.motion.way_m = {d.between(-0.005, 0.005), d.between(-0.005, 0.005), d.between(-0.0015, 0.0015)};
        c.motion.turn_rad = {d.between(-0.02, 0.02), d.between(-0.02, 0.02), d.between(-0.1, 0.1)};
        c.motion.rate_rad_per_s = 6.283 * d.between(0.3, 3.0);
        c.told_every_s = n % 2 == 0 ? 0.0 : d.between(0.001, 0.02);
        const moving_outcome o = run(c);
        const std::string which =
            "device " + std::to_string(r.device_hz) + " hand " + std::to_string(kind) + " n " + std::to_string(n);
        EXPECT_EQ(o.not_ok, 0U) << which;
        EXPECT_LE(o.surplus_j, most_surplus_j) << which;
        double& deepest = r.contact_hz < 500.0 ? deepest_slow : deepest_fast;
        deepest = std::max(deepest, o.deepest_m);
        surplus = std::max(surplus, o.surplus_j);
        if (c.told_every_s == 0.0) apart = std::max(apart, std::fabs(o.from_bodies_j - o.paid_j));
      }
    }
  }
  std::printf("  deepest %.3f mm, %.3f mm at 200 Hz; most energy %.5f mJ; books apart by %.5f mJ\n", 1e3 * deepest_fast,
              1e3 * deepest_slow, 1e3 * surplus, 1e3 * apart);
  EXPECT_LE(deepest_fast, 1e-4);
  EXPECT_LE(deepest_slow, 3e-4);
  EXPECT_LE(apart, 2e-4);
}

// The guard counts what a body gives as the body's, up to a power; without that it takes a lift for a fault.
TEST(moving_session, lifts_the_hand_without_the_guard) {
  const auto lifted = [](double bodies_power_w) {
    moving_case c = pressed(6.0, 1000, 1000);
    c.hand.capabilities = strong_device(20.0);
    c.hand.hand.stiffness_n_per_m = 100.0;
    c.hand.motion.depth_m = 0.002 + 6.0 / 100.0 + 6.0 / 500.0;
    c.motion.way_m = {0, 0, 0.05};
    c.motion.rate_rad_per_s = 6.0;
    c.motion.begins_s = 0.5;
    c.control.guard = {.bodies_power_w = bodies_power_w};
    c.length_s = 0.75;
    return run(c);
  };
  const moving_outcome o = lifted(guard_settings{}.bodies_power_w);
  EXPECT_EQ(o.guard_scale, 1.0);
  EXPECT_GT(o.delivered_j, 0.02);
  EXPECT_GT(o.from_bodies_j, 0.2);
  EXPECT_LT(lifted(0.01).guard_scale, 1.0);
}

}  // namespace
