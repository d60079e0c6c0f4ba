// What a session tells of presses that its planes do not answer: each flag where it should be, none in ordinary ones.
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include <asperity/control/linearise.hpp>
#include <asperity/control/virtual_coupling.hpp>
#include <asperity/control/virtual_session.hpp>
#include <asperity/render/tick_flag.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

/// Flags of all device ticks of a hand that presses with up to `newtons`. @param touch where the probe touches first
template <class Body>
tick_flag flags_reported_by(const Body& body, double newtons, const contact_law& law, const virtual_schedule& schedule,
                            const vec3& touch = vec3(0.0), const vec3& direction = {0, 0, -1},
                            const friction_settings& rubbing = {}) {
  struct watch {
    tick_flag reported = tick_flag::none;
    void operator()(const session_record& r) noexcept { reported |= r.flags; }
  };
  control_settings control;
  control.contact = law;
  control.friction = rubbing;
  control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(schedule.device_period_ns));
  simulated_device dev(hand_that_presses(newtons, touch, direction, control.coupling.stiffness_n_per_m));
  EXPECT_TRUE(dev.open() && dev.arm());
  virtual_session<Body, simulated_device, watch> session(body, {{pose{}}, vec3(0.0)}, dev, control, schedule);
  static_cast<void>(session.run_until(500'000'000));
  return session.device().observer().reported;
}

TEST(tick_flags, are_silent_up_to_twenty_newtons) {
  drawn d(seed_of(fresh_seed("tick_flags", "24 sessions"), "silent"));
  for (int i = 0; i < 24; ++i) {
    plane_body body = i % 3 == 0 ? block_on_plane() : i % 3 == 1 ? ball_in_corner(0.005) : plane_body{};
    if (i % 3 == 2) body.points_c = lower_face(0.01, 0.01, 0.01, 21);
    const vec3 tilt = d.inside(0.3), touch = i % 3 == 1 ? vec3(0.006, 0.006, 0.005) : vec3(0, 0, 0.01);
    const virtual_schedule schedule{.contact_period_ns = i % 2 == 0 ? 1'000'000 : 5'000'000,
                                    .contact_one_period_late = true};
    EXPECT_EQ(flags_reported_by(body, d.between(1.0, 20.0), {}, schedule, touch, glm::normalize(vec3(0, 0, -1) + tilt)),
              tick_flag::none)
        << i;
  }
}

TEST(tick_flags, report_a_wall_that_is_too_soft_to_hold) {
  EXPECT_EQ(flags_reported_by(plane_body{}, 10.0, {.stiffness_n_per_m = 5e3}, {}), tick_flag::not_held);
  EXPECT_EQ(flags_reported_by(plane_body{}, 2.0, {.stiffness_n_per_m = 5e3}, {}), tick_flag::none);  // 0.4 mm
}

// One pass of the solver answers a touch of a corner wrongly now and then, on planes of 50 N/mm in this one.
TEST(tick_flags, report_a_solver_that_was_stopped) {
  plane_body corner = ball_in_corner(0.005);
  corner.points_c = lower_face(0.005, 0.005, 0.005, 3);
  corner.radius_m = 0.0;
  EXPECT_TRUE(has(flags_reported_by(corner, 15.0, {.stiffness_n_per_m = 5e4, .most_passes = 1}, {},
                                    vec3(0.006, 0.006, 0.005), glm::normalize(vec3(-0.5, -0.6, -1))),
                  tick_flag::unbalanced));
  EXPECT_EQ(flags_reported_by(corner, 15.0, {}, {}, vec3(0.006, 0.006, 0.005), glm::normalize(vec3(-0.5, -0.6, -1))),
            tick_flag::none);
}

/// Planes all round a point, more directions than there is room for.
struct urchin {
  std::size_t directions = 40;
  double depth_m = 1e-5;
  std::vector<support_plane> planes{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    planes.clear();
    for (std::size_t i = 0; i < directions; ++i) {  // on a spiral from pole to pole
      const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(directions);
      const double turn = 2.399963229728653 * static_cast<double>(i), s = std::sqrt(1.0 - z * z);
      const vec3 n(s * std::cos(turn), s * std::sin(turn), z);
      planes.push_back({.depth_m = depth_m, .gradient = {n, vec3(0.0)}, .n_ab_w = n});
    }
    out.centre_of_mass_w = at.T_wa.position;
    out.planes = planes;
    return status::ok;
  }
};

tick_flag flags_of(urchin body, std::size_t dropped, tick_flag reported = tick_flag::none) {
  tick found;
  EXPECT_EQ(body.step({pose{}, {}}, found), status::ok);
  found.dropped_contacts = dropped;
  found.flags = reported;
  linear_contact contact;
  rest_prediction rest;
  linearise(found, status::ok, {}, {}, rest, contact);
  return contact.flags;
}

/// Floors of as many bodies as are asked for, all in one plane.
struct floors {
  std::uint32_t bodies = 1;
  std::vector<support_plane> planes{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    planes.clear();
    for (std::uint32_t i = 0; i < bodies; ++i) {
      planes.push_back({.depth_m = -at.T_wa.position.z, .gradient = {{0, 0, -1}, vec3(0.0)}, .n_ab_w = {0, 0, -1}});
      planes.back().body = i;
    }
    out.centre_of_mass_w = at.T_wa.position;
    out.planes = planes;
    return status::ok;
  }
};

TEST(tick_flags, report_a_body_without_friction) {
  for (const std::uint32_t bodies : {8U, 9U}) {
    for (const double mu : {0.0, 0.4}) {
      const bool told = bodies > friction::most_bodies && mu > 0.0;
      EXPECT_EQ(flags_reported_by(floors{bodies}, 2.0, {}, {}, vec3(0.0), {0, 0, -1},
                                  {.static_coefficient = mu, .dynamic_coefficient = mu}),
                told ? tick_flag::friction_left_out : tick_flag::none)
          << bodies << ' ' << mu;
    }
  }
}

TEST(tick_flags, report_planes_that_did_not_fit) {
  EXPECT_EQ(flags_of({.directions = 12}, 0), tick_flag::none);
  EXPECT_EQ(flags_of({.directions = 400}, 0), tick_flag::planes_left_out);
  EXPECT_EQ(flags_of({.directions = 400, .depth_m = -1e-4}, 0), tick_flag::none);  // gaps hold nothing
  EXPECT_EQ(flags_of({.directions = 6}, 1), tick_flag::planes_left_out);
  EXPECT_EQ(flags_of({.directions = 6}, 0, tick_flag::passed), tick_flag::passed);
  EXPECT_TRUE(has(flags_reported_by(urchin{.directions = 400}, 1.0, {}, {}), tick_flag::planes_left_out));
}

// A flag of one tick is in the contacts of the next 50 ms, so that a device thread that takes each twentieth sees it.
TEST(tick_flags, stay_for_slower_readers) {
  struct once {
    int ticks = 0;
    [[nodiscard]] status step(const scene_pose&, tick& out) noexcept {
      out = {};
      if (++ticks == 7) out.flags = tick_flag::passed;
      return status::ok;
    }
  };
  exchange shared;
  contact_loop<once> contact({}, {{pose{}}, vec3(0.0)}, shared);
  int seen = 0;
  for (std::int64_t now = 0; now < 200'000'000; now += 1'000'000) {
    shared.poses.back() = {pose{}, now};
    shared.poses.publish();
    EXPECT_EQ(contact.tick(now), status::ok);
    if ((now / 1'000'000) % 20 != 19) continue;
    EXPECT_TRUE(shared.contacts.refresh());
    seen += has(shared.contacts.front().flags, tick_flag::passed) ? 1 : 0;
  }
  EXPECT_GE(seen, 2);
  EXPECT_LE(seen, 3);
}

}  // namespace
