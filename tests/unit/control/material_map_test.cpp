// Bodies of several materials: what a hand feels on each part, on either body, and that no seam gives it energy.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/control/virtual_tool.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/model/material.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/planes/scene_editor.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/box_scene.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

const material ice = *preset_material("ice"), rubber = *preset_material("rubber"), steel = *preset_material("steel");

/// A model whose texels are of `first`, and of `other` where a point of its surface is on the other side.
textured_model in_two(textured_model model, const material& first, const material& other,
                      const std::function<bool(const vec3&)>& is_other) {
  model.surface = first;
  model.surface_map.others = {other};
  for (const glm::vec3& p : model.texture.texels) model.surface_map.texels.push_back(is_other(vec3(p)) ? 1 : 0);
  return model;
}
bool right_half(const vec3& p) { return p.x > 0.0; }

model_ptr shared(textured_model model) { return std::make_shared<const textured_model>(std::move(model)); }

/// Ice on the left, rubber on the right: flat, and with ridges of 20 um.
const model_ptr& slab(bool rough = false) {
  static const std::array<model_ptr, 2> made{
      shared(in_two(*boxes().table, ice, rubber, right_half)),
      shared(in_two(make_textured_box(table_half_m, 256, ridges(2e-5, 0.004)), ice, rubber, right_half))};
  return made[rough ? 1 : 0];
}

field_scene fields_of(const model_ptr& probe, const model_ptr& fixed) {
  return make_field_scene({probe, {fixed}}, few_samples).value();
}

/// A rotation that turns this corner of the tool down, and then about z.
quat corner_down(const vec3& sides, double turn_rad) {
  const vec3 corner = glm::normalize(tool_half_m * sides), down(0.0, 0.0, -1.0);
  const vec3 axis = glm::cross(corner, down);
  return exp_rotation({0, 0, turn_rad}) *
         exp_rotation(std::atan2(glm::length(axis), glm::dot(corner, down)) * glm::normalize(axis));
}

/// What a corner of the tool feels: stiffness of its one point under a light press, friction in a slide.
struct felt_at {
  double stiffness_n_per_m = 0.0, friction = 0.0;
};
felt_at feel(plane_renderer& renderer, const surface_pairs& surfaces, const quat& turned, const vec3& at,
             const vec3& slide) {
  constexpr double period_s = 1e-3, pressed_m = 2e-4, slide_m_per_s = 0.05;
  virtual_tool tool({.probe = solid_probe(boxes().tool->mass), .surfaces = surfaces});
  const double touch_z = table_half_m.z + corner_m();
  tool.place({turned, {at.x, at.y, touch_z + 5e-4}});
  const pose T_wb;
  felt_at out;
  tick found;
  double normal_n = 0.0, along_n = 0.0;
  for (int i = 1; i <= 700; ++i) {
    const double t = i * period_s;
    const double down_m = std::min(1.0, t / 0.2) * (5e-4 + pressed_m);
    const vec3 slid = slide_m_per_s * std::max(0.0, t - 0.5) * slide;
    const pose handle{turned, vec3(at.x, at.y, touch_z + 5e-4 - down_m) + slid};
    const status s = renderer.step({tool.T_wa(), {&T_wb, 1}}, found);
    EXPECT_EQ(s, status::ok);
    static_cast<void>(tool.follow(handle, period_s, found, s));
    const wrench pressed = tool.motion().pressed().on_probe_w, rubbed = tool.motion().rubbing().on_probe_w();
    if (i == 500) {
      const double depth_m = touch_z - tool.T_wa().position.z;
      std::size_t pressing = 0;
      for (const support_plane& p : found.planes) pressing += p.depth_m > 0.0 ? 1U : 0U;
      out.stiffness_n_per_m = pressing == 1 ? pressed.force.z / depth_m : 0.0;
    }
    if (i > 600) {
      normal_n += pressed.force.z;
      along_n -= glm::dot(rubbed.force, slide);
    }
  }
  out.friction = along_n / normal_n;
  return out;
}

/// The mean over poses of what is felt on one side, each against the pair's closed form.
void expect_pair(plane_renderer& renderer, const surface_pairs& surfaces, const vec3& corner, double side,
                 const surface_pair& wanted, drawn& d, const std::string& which) {
  int measured = 0;
  for (int n = 0; n < 6 && measured < 2; ++n) {
    const vec3 at(side * d.between(0.004, 0.02), d.between(-0.015, 0.015), 0.0);
    const double heading = d.between(-1.2, 1.2);  // away from the seam, and from the slab's edge
    const vec3 slide(side * std::cos(heading), std::sin(heading), 0.0);
    const felt_at f = feel(renderer, surfaces, corner_down(corner, d.between(0.0, 6.28)), at, slide);
    EXPECT_NEAR(f.friction, wanted.dynamic_friction, 0.02 * wanted.dynamic_friction) << which;
    if (!(f.stiffness_n_per_m > 0.0)) continue;  // a sample of the slab lies under the tip as well
    EXPECT_NEAR(f.stiffness_n_per_m, wanted.stiffness_n_per_m, 0.02 * wanted.stiffness_n_per_m) << which;
    ++measured;
  }
  EXPECT_GT(measured, 0) << which;
}

TEST(material_map, each_half_of_a_slab_is_its_own_material) {
  drawn d(seed_of(fresh_seed("material_map.each_half", "a slab of two materials"), "poses"));
  for (const bool plain : {false, true}) {  // the control: without its map the right half is of ice
    textured_model model = *slab();
    if (plain) model.surface_map = {};
    const scene bodies{boxes().tool, {shared(std::move(model))}};
    auto made = std::make_shared<const field_scene>(fields_of(bodies.probe, bodies.fixed[0]));
    plane_renderer renderer = make_plane_renderer(bodies, made).value();
    const surface_pairs surfaces = surfaces_of(bodies);
    expect_pair(renderer, surfaces, vec3(1.0), -1.0, *combined(std::nullopt, std::optional(ice)), d, "left");
    expect_pair(renderer, surfaces, vec3(1.0), 1.0, *combined(std::nullopt, std::optional(plain ? ice : rubber)), d,
                plain ? "without a map" : "right");
  }
}

TEST(material_map, the_probe_has_one_as_well) {
  drawn d(seed_of(fresh_seed("material_map.the_probe", "a tool of two materials"), "poses"));
  const scene bodies{shared(in_two(*boxes().tool, steel, rubber, right_half)), {slab()}};
  auto made = std::make_shared<const field_scene>(fields_of(bodies.probe, bodies.fixed[0]));
  plane_renderer renderer = make_plane_renderer(bodies, made).value();
  const surface_pairs surfaces = surfaces_of(bodies);
  EXPECT_EQ(surfaces.mapped.size(), 3U);
  for (const double corner : {-1.0, 1.0}) {
    for (const double side : {-1.0, 1.0}) {
      const surface_pair wanted = combined(corner > 0.0 ? rubber : steel, side > 0.0 ? rubber : ice);
      expect_pair(renderer, surfaces, {corner, 1.0, 1.0}, side, wanted, d,
                  "corner " + std::to_string(corner) + " side " + std::to_string(side));
    }
  }
}

// Two feet of one body on two materials: what holds is the mean of both, by how hard each presses.
TEST(material_map, friction_is_the_mean_of_what_presses) {
  drawn d(seed_of(fresh_seed("material_map.friction_is_the_mean", "20 pairs of feet"), "feet"));
  constexpr double h_s = 1e-4, mass_kg = 0.05, load_n = 4.0, foot_m = 0.01;
  for (int n = 0; n < 20; ++n) {
    const double mu_first = n % 5 == 0 ? 0.0 : d.between(0.0, 1.0), mu_other = d.between(0.0, 1.0);
    const double on_other = n % 4 == 0 ? 0.0 : d.between(0.05, 0.95);  // share of the load
    surface_pairs pairs{surface_pair{.static_friction = mu_first, .dynamic_friction = mu_first}};
    pairs.mapped = {{0, 0, 1, {.static_friction = mu_other, .dynamic_friction = mu_other}}};
    const contact_laws laws({}, pairs);
    friction rubbing;
    vec6 v{};
    vec3 rubbed_n(0.0), at(0.0);
    double tilt_rad = 0.0;
    for (int i = 0; i < 6000; ++i) {
      const auto foot = [&](double x, std::uint8_t of_body) {
        const vec3 r(x, 0.0, 0.0), slope(0, 0, -1);
        return support_plane{.depth_m = -at.z + tilt_rad * x,
                             .gradient = {slope, glm::cross(r, slope)},
                             .n_ab_w = slope,
                             .r_w = r,
                             .body = 0,
                             .sample = of_body + 1U,
                             .of_body = of_body};
      };
      support_planes planes;
      static_cast<void>(planes.push_back(foot(-foot_m, 0)));
      if (on_other > 0.0) static_cast<void>(planes.push_back(foot(foot_m, 1)));
      mat6 a;
      for (std::size_t k = 0; k < 6; ++k) a(k, k) = (k < 3 ? mass_kg : 1e-4) / h_s;
      // The load is where it presses the feet by their shares; a push along the surface, far beyond what holds.
      const double x = on_other > 0.0 ? foot_m * (2.0 * on_other - 1.0) : -foot_m;
      const vec6 load{{0.0, 2.0 * load_n, -load_n}, {0.0, x * load_n, 0.0}};
      const contact_solution s = rubbing.solve(a, load, v, h_s, planes, {}, laws);
      ASSERT_TRUE(s.solved);
      v = s.velocity;
      v.angular.z = 0.0;
      rubbing.settle(h_s, v);
      rubbed_n = rubbing.on_probe_w().force;
      at += h_s * v.linear;
      tilt_rad += h_s * v.angular.y;
    }
    const double mean = (1.0 - on_other) * mu_first + on_other * mu_other;
    EXPECT_NEAR(-rubbed_n.y, mean * load_n, 0.02 * load_n) << mu_first << ' ' << mu_other << ' ' << on_other;
  }
}

// A slab with a map that comes into a scene, in the place of one without, is felt by its map where the hand is.
TEST(material_map, is_felt_in_a_scene_that_changes) {
  for (const double side : {-1.0, 1.0}) {
    for (const bool late : {false, true}) {  // far from the hand when it comes, or under it
      scene_editor editor = scene_editor::make(boxes().tool, {.bodies = 4}, few_samples).value();
      const body_handle table = editor.add(boxes().table, boxes().field_of(boxes().table), pose{}).value();
      simulated_settings hand =
          hand_that_presses(0.3, {side * 0.01, 0.0, table_half_m.z + corner_m()}, {0, 0, -1}, 2000.0);
      simulated_device dev(hand);
      ASSERT_TRUE(dev.open() && dev.arm());
      control_settings control;
      control.surfaces = editor.surfaces();
      control.map.T_ha.rotation = test_support::corner_down();
      virtual_session<plane_renderer, simulated_device> session(make_plane_renderer(editor).value(), {{}, vec3(0.0)},
                                                                dev, control);
      static_cast<void>(session.run_until(late ? 800'000'000 : 10'000'000));
      ASSERT_TRUE(editor.exchange(table, slab(), boxes().field_of(boxes().table)));
      ASSERT_TRUE(editor.commit(session.scenes()));
      static_cast<void>(session.run_until(1'600'000'000));
      const double depth_m = table_half_m.z + corner_m() - session.device().probe().state().T_wc.position.z;
      const double pressed_n = session.device().pressed().on_probe_w.force.z;
      EXPECT_GT(pressed_n, 0.1);
      EXPECT_NEAR(pressed_n / depth_m, side > 0.0 ? rubber.stiffness_n_per_m : ice.stiffness_n_per_m,
                  0.05 * (side > 0.0 ? rubber.stiffness_n_per_m : ice.stiffness_n_per_m))
          << side << ' ' << late;
    }
  }
}

// A plane tells of which material its point is on either body, to a texel, whosever sample it is of.
TEST(material_map, planes_tell_the_texel) {
  drawn d(seed_of(fresh_seed("material_map.planes_tell", "60 poses"), "poses"));
  const auto checkered = [](double cell_m) {
    return [cell_m](const vec3& p) {
      const vec3 i = glm::floor(p / cell_m);
      return std::fmod(std::fabs(i.x + i.y + i.z), 2.0) > 0.5;
    };
  };
  constexpr double cell_m = 0.0021;
  const auto is_other = checkered(cell_m);
  const scene bodies{shared(in_two(*boxes().tool, steel, ice, is_other)),
                     {shared(in_two(*boxes().table, ice, rubber, is_other))}};
  auto made = std::make_shared<const field_scene>(fields_of(bodies.probe, bodies.fixed[0]));
  plane_renderer renderer = make_plane_renderer(bodies, made).value();
  const auto far_from_a_seam = [](const vec3& p, const vec3& half) {
    for (int k = 0; k < 3; ++k) {
      const double f = p[k] / cell_m - std::floor(p[k] / cell_m);
      if (std::fabs(std::fabs(p[k]) - half[k]) > 1e-4 && std::min(f, 1.0 - f) * cell_m < 4e-4) return false;
    }
    return true;
  };
  std::size_t told[2][2]{}, wrong = 0, all = 0;
  for (int n = 0; n < 60; ++n) {
    const quat turned = exp_rotation({d.between(-0.02, 0.02), d.between(-0.02, 0.02), d.between(0.0, 6.28)});
    const pose T_wa{turned, {d.between(-0.02, 0.02), d.between(-0.02, 0.02), table_half_m.z + tool_half_m.z}};
    const pose T_wb;
    tick found;
    ASSERT_EQ(renderer.step({T_wa, {&T_wb, 1}}, found), status::ok);
    for (const support_plane& p : found.planes) {
      ++told[p.of_probe][p.of_body];
      if (p.depth_m < -5e-4) continue;
      const vec3 of_sample = p.r_w + found.centre_of_mass_w;
      const vec3 on_other = of_sample - p.depth_m * p.n_ab_w * (p.sample % 2 == 1 ? 1.0 : -1.0);
      const vec3 on_probe = inverse(T_wa) * (p.sample % 2 == 1 ? of_sample : on_other);
      const vec3 on_body = p.sample % 2 == 1 ? on_other : of_sample;
      if (far_from_a_seam(on_probe, tool_half_m)) {
        ++all;
        wrong += is_other(on_probe) != (p.of_probe == 1) ? 1U : 0U;
      }
      if (far_from_a_seam(on_body, table_half_m)) {
        ++all;
        wrong += is_other(on_body) != (p.of_body == 1) ? 1U : 0U;
      }
    }
  }
  for (const auto& row : told) {
    for (const std::size_t count : row) EXPECT_GT(count, 100U);
  }
  std::printf("  %zu of %zu materials told wrong\n", wrong, all);
  EXPECT_GT(all, 1000U);
  EXPECT_LE(wrong, all / 200);
}

/// The same materials without what takes energy, so that nothing hides what a seam gives.
material slick(material m) {
  m.dissipation_s_per_m = m.static_friction = m.dynamic_friction = 0.0;
  return m;
}
scene slick_scene(bool probe_too, bool rough) {
  const auto of = [](textured_model m) {
    m.surface = slick(*m.surface);
    m.surface_map.others = {slick(m.surface_map.others[0])};
    return shared(std::move(m));
  };
  return {probe_too ? of(in_two(*boxes().tool, steel, rubber, right_half)) : boxes().tool, {of(*slab(rough))}};
}

// A corner that is led into the slab, over the seam to and fro, and out again: what its points' springs have done on it in
// all is no work, though they are 28 times as stiff where it leaves. (Of the slab's own points each stays of its material.)
TEST(material_map, the_springs_do_no_work_on_a_way_over_the_seam) {
  drawn d(seed_of(fresh_seed("material_map.the_springs_do_no_work", "16 ways"), "ways"));
  double most = -1.0;
  for (const bool probe_too : {false, true}) {
    const scene bodies = slick_scene(probe_too, false);
    const auto made = std::make_shared<const field_scene>(fields_of(bodies.probe, bodies.fixed[0]));
    plane_renderer renderer = make_plane_renderer(bodies, made, {.reach_m = 0.0018}).value();
    const contact_laws laws({}, surfaces_of(bodies));
    for (int n = 0; n < 8; ++n) {
      const quat turned = corner_down({n % 2 == 0 ? 1.0 : -1.0, 1.0, 1.0}, d.between(0.0, 6.28));
      double low_m = 0.0;
      for (const vec3& p : boxes().tool->mesh.positions) low_m = std::min(low_m, (turned * p).z);
      const double top_m = table_half_m.z - low_m, deep_m = d.between(1e-4, 5e-4), far_m = d.between(0.003, 0.006);
      const int passes = 1 + static_cast<int>(d.bits() % 4);  // over the seam, from either side
      const double from_m = (n / 2 % 2 == 0 ? 1.0 : -1.0) * far_m;
      std::vector<vec3> corners{{from_m, 0, top_m + 1e-5}, {from_m, 0, top_m - deep_m}};
      for (int i = 1; i <= passes; ++i) corners.push_back({i % 2 == 1 ? -from_m : from_m, 0, top_m - deep_m});
      corners.push_back({corners.back().x, 0, top_m + 1e-3});
      double work_j = 0.0, most_stored_j = 0.0;
      std::optional<vec3> before_n;
      const auto visit = [&](const vec3& at, const vec3& step) {
        const pose T_wa{turned, at}, T_wb;
        tick found;
        EXPECT_EQ(renderer.step({T_wa, {&T_wb, 1}}, found), status::ok);
        vec3 force_n(0.0);
        double stored_j = 0.0;
        for (const support_plane& p : found.planes) {
          if (p.sample % 2 == 0) continue;  // of the slab's samples
          const double pressed_n = laws.stiffness_n_per_m(p) * std::max(0.0, p.depth_m);
          force_n -= pressed_n * p.gradient.linear;
          stored_j += 0.5 * pressed_n * std::max(0.0, p.depth_m);
        }
        work_j += glm::dot(0.5 * (before_n.value_or(force_n) + force_n), step);
        most_stored_j = std::max(most_stored_j, stored_j);
        before_n = force_n;
      };
      visit(corners[0], vec3(0.0));
      for (std::size_t i = 1; i < corners.size(); ++i) {
        const vec3 way = corners[i] - corners[i - 1];
        const bool sinks = std::fabs(way.z) > 0.0;
        const auto steps = static_cast<int>(std::ceil(glm::length(way) / (sinks ? 5e-6 : 2e-5)));
        for (int k = 1; k <= steps; ++k)
          visit(corners[i - 1] + (static_cast<double>(k) / steps) * way, way / (1.0 * steps));
      }
      EXPECT_LE(work_j, 0.02 * most_stored_j) << "way " << n << " probe " << probe_too << " passes " << passes;
      most = std::max(most, work_j / most_stored_j);
    }
  }
  std::printf("  at most %.3f of what was stored\n", most);
}

/// A session with a hand that goes to and fro over the seam; the most energy that the hand was given.
struct seam_outcome {
  double surplus_j = 0.0;
  std::array<std::uint64_t, 2> pressed{};  // ticks in which a plane of each material pressed
  std::uint64_t crossings = 0, not_ok = 0;
};

seam_outcome scrub_over_seam(plane_renderer renderer, const surface_pairs& surfaces, const simulated_settings& hand,
                             const virtual_schedule& schedule, const quat& turned, double length_s) {
  struct watch {
    session_record last;
    void operator()(const session_record& r) noexcept { last = r; }
  };
  simulated_device dev(hand);
  EXPECT_TRUE(dev.open() && dev.arm());
  control_settings control;
  control.guard.enabled = false;
  control.surfaces = surfaces;
  control.probe = solid_probe(boxes().tool->mass);
  control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(schedule.device_period_ns));
  control.map.T_ha.rotation = turned;
  virtual_session<plane_renderer, simulated_device, watch> session(std::move(renderer), {{pose{}}, vec3(0.0)}, dev,
                                                                   control, schedule);
  seam_outcome out;
  double surplus_j = 0.0, before_j = 0.0;
  bool right = false;
  while (1e-9 * static_cast<double>(session.now_ns()) < length_s) {
    if (session.step() != status::ok) ++out.not_ok;
    const session_record& r = session.device().observer().last;
    surplus_j = std::max(-0.1, surplus_j + dev.delivered_j() - before_j);
    before_j = dev.delivered_j();
    out.surplus_j = std::max(out.surplus_j, surplus_j);
    std::array<bool, 2> touches{};
    for (const support_plane& p : session.contact().last().planes) {
      if (p.depth_m > 0.0) touches[p.of_body] = true;
    }
    for (std::size_t m = 0; m < 2; ++m) out.pressed[m] += touches[m] ? 1U : 0U;
    const bool now = r.T_wa.position.x > 0.0;
    if (now != std::exchange(right, now) && (touches[0] || touches[1])) ++out.crossings;
  }
  return out;
}

// Corners, edges and faces of a box, over the seam of ice and rubber again and again: light and firm hands, 200 Hz to
// 10 kHz, one period late, without the guard.
TEST(material_map, a_seam_makes_no_energy) {
  drawn d(seed_of(fresh_seed("material_map.a_seam", "sessions over a seam"), "hands"));
  constexpr double no_surplus_j = 1e-5;
  struct rates {
    double device_hz, contact_hz;
  };
  constexpr std::array<rates, 4> of{{{10'000, 10'000}, {4000, 1000}, {1000, 1000}, {200, 200}}};
  const double length_s = at_length() ? 1.2 : 0.6;
  double most_j = 0.0;
  std::uint64_t crossings = 0;
  for (const bool probe_too : {false, true}) {
    for (const bool rough : {false, true}) {
      const scene bodies = slick_scene(probe_too, rough);
      const auto made = std::make_shared<const field_scene>(fields_of(bodies.probe, bodies.fixed[0]));
      for (const rates& r : of) {
        if (r.device_hz > 5e3 && !at_length()) continue;
        for (int n = 0; n < extent(1, 2); ++n) {
          simulated_settings hand;
          hand.seed = d.bits();
          hand.hand = d.bits() % 2 == 0 ? soft_hand() : firm_hand();
          const int how = static_cast<int>(d.bits() % 3);
          const quat turned =
              how == 0
                  ? corner_down(vec3(1.0), d.between(0.0, 6.28))
                  : exp_rotation({how == 1 ? d.between(0.1, 1.4) : d.between(-0.02, 0.02), 0.0, d.between(-1.0, 1.0)});
          double low_m = 0.0;
          for (const vec3& p : boxes().tool->mesh.positions) low_m = std::min(low_m, (turned * p).z);
          motion_settings& m = hand.motion;
          m.kind = motion_kind::scrub;
          m.T_dh.position = {d.between(-0.002, 0.002), 0.0, table_half_m.z - low_m + 0.001};
          const double heading = d.between(-0.6, 0.6);
          m.sideways_d = {std::cos(heading), std::sin(heading), 0.0};
          m.depth_m = d.between(0.003, 0.02);
          m.approach_s = 0.15;
          m.amplitude_m = d.between(0.003, 0.008);
          m.frequency_hz = d.between(1.0, 4.0);
          const virtual_schedule schedule{.device_period_ns = static_cast<std::int64_t>(1e9 / r.device_hz),
                                          .contact_period_ns = static_cast<std::int64_t>(1e9 / r.contact_hz),
                                          .contact_one_period_late = true};
          const double reach_m = reach_for(1e-9 * static_cast<double>(schedule.periods().renewal_ns()));
          const seam_outcome o = scrub_over_seam(make_plane_renderer(bodies, made, {.reach_m = reach_m}).value(),
                                                 surfaces_of(bodies), hand, schedule, turned, length_s);
          EXPECT_EQ(o.not_ok, 0U);
          EXPECT_LE(o.surplus_j, no_surplus_j)
              << "device " << r.device_hz << " contact " << r.contact_hz << " how " << how << " hand " << n << " probe "
              << probe_too << " rough " << rough << " depth " << m.depth_m;
          most_j = std::max(most_j, o.surplus_j);
          crossings += o.crossings;
          EXPECT_GT(o.pressed[0] + o.pressed[1], 0U);
        }
      }
    }
  }
  std::printf("  most energy %.5f mJ in %llu crossings\n", 1e3 * most_j, static_cast<unsigned long long>(crossings));
  EXPECT_GT(crossings, 20U);
}

}  // namespace
