#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include <asperity/control/virtual_coupling.hpp>
#include <asperity/control/virtual_tool.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

/// The loop of a program that calls a renderer by itself: the handle goes down to z and stays.
wrench press_by_hand(virtual_tool& tool, plane_body body, const pose& from, double to_z, int steps,
                     double* deepest_m = nullptr) {
  tool.place(from);
  wrench felt;
  tick found;
  for (int i = 1; i <= steps; ++i) {
    pose T_wh = from;
    T_wh.position.z += (to_z - from.position.z) * smoothstep(2.0 * i / steps);
    const status s = body.step({tool.T_wa(), {}}, found);
    felt = tool.follow(T_wh, 1e-3, found, s);
    EXPECT_EQ(tool.last(), status::ok);
    if (deepest_m != nullptr) *deepest_m = std::max(*deepest_m, body.depth_m(tool.T_wa()));
  }
  return felt;
}

TEST(virtual_tool, feels_a_face_as_stiff_as_its_coupling) {
  virtual_tool tool({});
  double deepest = 0.0;
  const wrench felt = press_by_hand(tool, block_on_plane(), {quat(1, 0, 0, 0), {0, 0, 0.013}}, -0.01, 1000, &deepest);
  EXPECT_NEAR(felt.force.z, 500.0 * 0.02, 0.05);
  EXPECT_NEAR(felt.force.x, 0.0, 1e-9);
  EXPECT_LT(deepest, 1e-4);
  EXPECT_EQ(tool.contact().answer, status::ok);
  EXPECT_GE(tool.contact().planes.size(), 4U);
  EXPECT_NEAR(tool.motion().touched().on_probe_w.force.z, felt.force.z, 1e-3);
}

TEST(virtual_tool, feels_a_renderer_without_planes_as_well) {
  virtual_tool tool({});
  plane_body line = block_on_plane();
  line.reports_planes = false;
  line.linear_n_per_m = 2000.0 / 25.0;
  const wrench felt = press_by_hand(tool, line, {quat(1, 0, 0, 0), {0, 0, 0.013}}, -0.01, 1000);
  EXPECT_NEAR(felt.force.z, 0.02 / (1.0 / 500.0 + 1.0 / 2000.0), 0.05);
  EXPECT_TRUE(tool.contact().planes.empty());
}

// The probe hangs on the handle by T_ha, and its centre of mass is not its origin: what is felt is about the handle.
TEST(virtual_tool, reports_its_wrench_about_the_handle) {
  drawn d(seed_of(fresh_seed("virtual_tool", "20 handles"), "handle"));
  for (int i = 0; i < 20; ++i) {
    const pose T_ha{exp_rotation(d.inside(2.0)), d.inside(0.1)};
    const vec3 centre = d.inside(0.03);
    virtual_tool tool({.T_ha = T_ha, .centre_of_mass_a = centre});
    const pose T_wh{exp_rotation(d.inside(2.0)), d.inside(0.2)};
    tool.place(T_wh);
    EXPECT_LT(glm::length(tool.T_wa().position - (T_wh * T_ha).position), 1e-15);
    // A renderer that pushes with one newton through c_A, for so long that all rests.
    const vec3 push = d.direction();
    tick found;
    found.force.on_probe_w.force = push;
    wrench felt;
    for (int n = 0; n < 400; ++n) felt = tool.follow(T_wh, 1e-3, found);
    const vec3 c = tool.T_wa() * centre;
    EXPECT_LT(glm::length(felt.force - push), 1e-6);
    const vec3 target = T_wh * (T_ha * centre);
    EXPECT_LT(glm::length(felt.torque - glm::cross(target - T_wh.position, push)), 1e-6);
    EXPECT_LT(glm::length(c - target - push / 500.0), 1e-6);
  }
}

// Told where a late tick was rendered, it is held in the same place; not told, it takes old planes for new ones.
TEST(virtual_tool, takes_a_tick_that_was_rendered_earlier) {
  const auto press_late = [](bool tells) {
    virtual_tool tool({});
    plane_body body = block_on_plane();
    tool.place({quat(1, 0, 0, 0), {0, 0, 0.013}});
    tick found;
    pose then;
    double deepest = 0.0;
    for (int i = 0; i < 600; ++i) {
      if (i % 10 == 0) {
        then = tool.T_wa();
        EXPECT_EQ(body.step({then, {}}, found), status::ok);
      }
      const pose T_wh{quat(1, 0, 0, 0), {0, 0, 0.013 - 0.02 * smoothstep(i / 300.0)}};
      static_cast<void>(tells ? tool.follow(T_wh, 1e-3, found, status::ok, then) : tool.follow(T_wh, 1e-3, found));
      deepest = std::max(deepest, body.depth_m(tool.T_wa()));
    }
    return deepest;
  };
  EXPECT_LT(press_late(true), 1e-4);
  EXPECT_GT(press_late(false), 3e-4);
}

TEST(virtual_tool, puts_out_nothing_it_cannot_answer_for) {
  virtual_tool tool({});
  const pose start{quat(1, 0, 0, 0), {0, 0, 0.005}};
  tool.place(start);
  plane_body body = block_on_plane();
  tick found;
  ASSERT_EQ(body.step({start, {}}, found), status::ok);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(is_zero(tool.follow({quat(1, 0, 0, 0), vec3(nan)}, 1e-3, found)));
  EXPECT_EQ(tool.last(), status::invalid_pose);
  EXPECT_TRUE(is_zero(tool.follow({quat(2, 0, 0, 0), vec3(0.0)}, 1e-3, found)));
  EXPECT_EQ(tool.last(), status::invalid_pose);
  EXPECT_TRUE(is_zero(tool.follow(start, nan, found)));
  EXPECT_TRUE(is_zero(tool.follow(start, 1e-3, found, status::ok, {quat(0, 0, 0, 0), vec3(0.0)})));
  EXPECT_LT(glm::length(tool.T_wa().position - start.position), 1e-15);  // and nothing moved
  // A renderer that failed leaves no contact, whatever stands in the tick.
  static_cast<void>(tool.follow(start, 1e-3, found, status::backend_failed));
  EXPECT_EQ(tool.contact().answer, status::backend_failed);
  EXPECT_TRUE(tool.contact().planes.empty());
  EXPECT_TRUE(is_zero(tool.motion().touched().on_probe_w));
  // A plane that is not finite is told, and goes no further.
  body.planes[0].depth_m = nan;
  static_cast<void>(tool.follow(start, 1e-3, found));
  EXPECT_EQ(tool.contact().answer, status::not_finite);
  EXPECT_TRUE(is_zero(tool.motion().touched().on_probe_w));
  // A long pause is one step of 20 ms.
  const pose away{quat(1, 0, 0, 0), {0, 0, 1.005}};
  tool.place(start);
  static_cast<void>(tool.follow(away, 10.0, {}));
  EXPECT_EQ(tool.last(), status::ok);
}

device_capabilities device_of(double k, double hz) {
  device_capabilities c;
  c.max_stiffness_n_per_m = k;
  c.max_stiffness_n_m_per_rad = 0.01 * k;
  c.max_stiffness_rate_hz = hz;
  return c;
}

TEST(coupling_for, takes_half_of_what_the_device_holds_at_the_rate) {
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 1000), 1000).stiffness_n_per_m, 1500.0);
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 1000), 1000).stiffness_n_m_per_rad, 15.0);
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 1000), 500).stiffness_n_per_m, 750.0);
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 1000), 4000).stiffness_n_per_m, 1500.0);  // structure, not sampling
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 0), 100).stiffness_n_per_m, 1500.0);
  const coupling_settings unknown = coupling_for({}, 1000);
  EXPECT_EQ(unknown.stiffness_n_per_m, coupling_settings{}.stiffness_n_per_m);
  EXPECT_EQ(unknown.stiffness_n_m_per_rad, coupling_settings{}.stiffness_n_m_per_rad);
}

TEST(coupling_for, leaves_a_way_to_steer_in) {
  device_capabilities weak = device_of(20'000, 1000);
  weak.peak_force_n = 4.0;
  weak.peak_torque_n_m = 0.1;
  EXPECT_DOUBLE_EQ(coupling_for(weak, 1000).stiffness_n_per_m, 2000.0);
  EXPECT_DOUBLE_EQ(coupling_for(weak, 1000).stiffness_n_m_per_rad, 2.0);
}

// With a map that doubles the motion a spring of the world is felt four times as stiff.
TEST(coupling_for, counts_in_the_units_of_the_world) {
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 1000), 1000, 2.0).stiffness_n_per_m, 375.0);
  EXPECT_DOUBLE_EQ(coupling_for(device_of(3000, 1000), 1000, 2.0).stiffness_n_m_per_rad, 15.0);
}

// On the simulated device, three hands on a hard face, contacts one period late, no guard: no energy at any rate.
// Twenty times as stiff the device does not hold it.
TEST(coupling_for, is_passive_on_the_simulated_device) {
  drawn d(seed_of(fresh_seed("coupling_for", "24 sessions"), "coupling"));
  double too_stiff_j = 0.0;
  for (const double hz : {500.0, 1000.0, 2000.0, 4000.0}) {
    for (int kind = 0; kind < 6; ++kind) {
      plane_case c;
      c.body = block_on_plane();
      c.control.guard.enabled = false;
      c.control.coupling = coupling_for(simulated_capabilities(), hz);
      c.schedule = {.device_period_ns = static_cast<std::int64_t>(1e9 / hz),
                    .contact_period_ns = 5'000'000,
                    .contact_one_period_late = true};
      c.hand = hand_that_presses(6.0, {0, 0, 0.013}, {0, 0, -1}, c.control.coupling.stiffness_n_per_m);
      c.hand.motion.depth_m += 0.003;  // from so high that a tilted block is clear of the face
      c.hand.seed = d.bits();
      c.hand.hand = kind % 3 == 0 ? soft_hand() : (kind % 3 == 1 ? firm_hand() : hand_settings{});
      if (kind % 3 == 2) c.hand.motion.kind = motion_kind::tap;
      if (kind >= 3) c.hand.motion.T_dh.rotation = exp_rotation(d.inside(0.2));
      c.hand.motion.frequency_hz = d.between(1.0, 5.0);
      const plane_outcome o = run(c);
      EXPECT_LE(o.surplus_j, 1e-5) << hz << ' ' << kind;
      c.control.coupling.stiffness_n_per_m *= 20.0;
      too_stiff_j = std::max(too_stiff_j, run(c).surplus_j);
    }
  }
  std::printf("  twenty times as stiff: %.2f mJ\n", 1e3 * too_stiff_j);
  EXPECT_GT(too_stiff_j, 1e-4);
}

}  // namespace
