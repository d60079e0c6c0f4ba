// The finder on scenes whose contacts are known.
#include "asperity/window/convex_piece_finder.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <set>
#include <vector>

#include "session/rt/tick_trap.hpp"
#include "support/piece_models.hpp"
#include "window/clustering.hpp"
#include "window/contact_builder.hpp"

namespace asperity {
namespace {

using test::box_mesh;
using test::cut_into;
using test::make_piece_model;

constexpr std::array every_cut{cut_into::one_piece, cut_into::flat_faces, cut_into::triangles};

/// A finder with one fixed body at the origin.
struct rig {
  scene bodies;
  convex_piece_finder finder;
  contact_set out;
  std::array<pose, 1> T_wb{};

  rig(model_ptr probe, model_ptr fixed, const window_finder_settings& settings = {}, contact_limits limits = {})
      : bodies{std::move(probe), {std::move(fixed)}}, finder(bodies, settings), out(limits) {}

  status at(const pose& T_wa) { return finder.find({T_wa, T_wb}, out); }
  const contact& only() const { return out.contacts().front(); }
};

rig box_on_plate(cut_into how, const window_finder_settings& settings = {}) {
  return {make_piece_model(box_mesh({0.02, 0.02, 0.02}, 2), how),
          make_piece_model(box_mesh({0.05, 0.05, 0.01}, 3), how), settings};
}

/// What is true of every contact, whatever the scene.
void expect_sound(const rig& r, const pose& T_wa) {
  for (const contact& c : r.out.contacts()) {
    const contact_window& w = c.window;
    EXPECT_NEAR(glm::length(w.n_ab_w), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(w.u_w), 1.0, 1e-12);
    EXPECT_NEAR(glm::distance(glm::cross(w.u_w, w.v_w), w.n_ab_w), 0.0, 1e-12);
    EXPECT_GT(w.half_size_m, 0.0);
    EXPECT_NEAR(c.separation_m, glm::dot(c.p_b_w - c.p_a_w, w.n_ab_w), 1e-15);
    const auto check = [&](std::span<const std::uint32_t> patch, const coarse_mesh& mesh, const pose& T, double side) {
      EXPECT_FALSE(patch.empty());
      const std::set<std::uint32_t> once(patch.begin(), patch.end());
      EXPECT_EQ(once.size(), patch.size());
      for (const std::uint32_t t : patch) {
        EXPECT_GT(side * glm::dot(T.rotation * glm::normalize(area_normal(corners(mesh, t))), w.n_ab_w), 0.1);
      }
    };
    check(r.out.patch_a(c), r.bodies.probe->mesh, T_wa, 1.0);
    check(r.out.patch_b(c), r.bodies.fixed[0]->mesh, r.T_wb[0], -1.0);
  }
}

TEST(finder, one_contact_between_flat_faces_however_they_are_cut) {
  for (const cut_into how : every_cut) {
    rig r = box_on_plate(how);
    for (const double gap : {2e-4, 1e-5, 0.0, -1e-5, -1e-4, -1e-3, -4e-3}) {
      const pose T{{1.0, 0.0, 0.0, 0.0}, {0.004, -0.003, 0.03 + gap}};
      ASSERT_EQ(r.at(T), status::ok);
      ASSERT_EQ(r.out.size(), 1U) << "gap " << gap;
      expect_sound(r, T);
      const contact& c = r.only();
      EXPECT_NEAR(c.window.n_ab_w.z, -1.0, 1e-9);
      EXPECT_NEAR(c.separation_m, gap, 1e-9);
      EXPECT_NEAR(c.p_a_w.z, 0.01 + gap, 1e-9);
      EXPECT_NEAR(c.p_b_w.z, 0.01, 1e-9);
      // The window covers the whole overlap and little else, and is centred on it between the surfaces.
      EXPECT_NEAR(glm::distance(c.window.centre_w, vec3(0.004, -0.003, 0.01 + 0.5 * gap)), 0.0, 1e-9);
      EXPECT_NEAR(c.window.half_size_m, 0.021, 1e-9);
      EXPECT_EQ(c.count_a, 8U);   // the bottom
      EXPECT_EQ(c.count_b, 18U);  // the top
    }
  }
}

TEST(finder, edge_and_corner_contacts_take_the_plates_normal) {
  const double root = std::sqrt(0.5), corner = 0.02 * std::sqrt(3.0), edge = 0.04 * root;
  for (const cut_into how : every_cut) {
    rig r = box_on_plate(how);
    for (const double gap : {1e-4, -1e-4, -2e-3}) {
      const pose on_edge{exp_rotation({std::acos(root), 0.0, 0.0}), {0.004, 0.0, 0.01 + edge + gap}};
      ASSERT_EQ(r.at(on_edge), status::ok);
      ASSERT_EQ(r.out.size(), 1U);
      expect_sound(r, on_edge);
      EXPECT_NEAR(r.only().window.n_ab_w.z, -1.0, 1e-9);
      EXPECT_NEAR(r.only().separation_m, gap, 1e-5);
      EXPECT_NEAR(r.only().p_a_w.y, 0.0, 1e-5);
      EXPECT_GE(r.only().window.half_size_m, 0.02);  // the whole edge

      const pose on_corner{
          exp_rotation({0.0, std::asin(1.0 / std::sqrt(3.0)), 0.0}) * exp_rotation({std::acos(root), 0.0, 0.0}),
          {0.004, 0.0, 0.01 + corner + gap}};
      ASSERT_EQ(r.at(on_corner), status::ok);
      ASSERT_EQ(r.out.size(), 1U);
      expect_sound(r, on_corner);
      EXPECT_NEAR(r.only().window.n_ab_w.z, -1.0, 1e-9);
      EXPECT_NEAR(r.only().separation_m, gap, 1e-4);
      EXPECT_NEAR(glm::distance(vec2(r.only().p_a_w), vec2(0.004, 0.0)), 0.0, 1e-4);
    }
  }
}

TEST(finder, sliding_keeps_one_contact_its_id_and_its_normal) {
  for (const cut_into how : every_cut) {
    rig r = box_on_plate(how);
    std::uint32_t id = 0;
    vec3 centre(0.0);
    for (int k = 0; k <= 1000; ++k) {
      const double s = k / 1000.0;
      const pose T{{1.0, 0.0, 0.0, 0.0}, {-0.02 + 0.05 * s, 0.01 * std::sin(6.0 * s), 0.03 - 2e-4 + 3e-4 * s}};
      ASSERT_EQ(r.at(T), status::ok);
      ASSERT_EQ(r.out.size(), 1U) << "tick " << k;
      const contact& c = r.only();
      if (k == 0) id = c.id;
      EXPECT_EQ(c.id, id);
      EXPECT_NEAR(c.window.n_ab_w.z, -1.0, 1e-9);
      // 78 um per tick at most; the overlap's middle moves no faster than the box.
      if (k > 0) {
        EXPECT_LT(glm::distance(c.window.centre_w, centre), 1e-4) << "tick " << k;
      }
      centre = c.window.centre_w;
    }
  }
}

/// Largest step of window centre, half-size and normal while a box rocks on its edges, `ticks` poses in all.
std::array<double, 3> largest_steps(cut_into how, int ticks) {
  rig r = box_on_plate(how);
  std::array<double, 3> steps{};
  contact_window last;
  for (int k = 0; k <= ticks; ++k) {
    const double angle = 0.025 * (2.0 * k / ticks - 1.0);
    const double lowest = 0.02 * (std::cos(angle) + std::fabs(std::sin(angle)));
    EXPECT_EQ(r.at({exp_rotation({angle, 0.0, 0.0}), {0.003, 0.0, 0.01 + lowest}}), status::ok);
    if (r.out.size() != 1U || r.only().id != 0U) return {1.0, 1.0, 1.0};
    const contact_window& w = r.only().window;
    if (k > 0) {
      steps[0] = std::max(steps[0], glm::distance(w.centre_w, last.centre_w));
      steps[1] = std::max(steps[1], std::fabs(w.half_size_m - last.half_size_m));
      steps[2] = std::max(steps[2], glm::distance(w.n_ab_w, last.n_ab_w));
    }
    last = w;
  }
  return steps;
}

TEST(finder, rocking_moves_the_window_continuously) {
  for (const cut_into how : every_cut) {
    const auto coarse = largest_steps(how, 300);
    const auto fine = largest_steps(how, 3000);
    // What jumps keeps its step when the motion is cut finer; what is continuous divides it by ten.
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(fine[i], 0.3 * coarse[i] + 1e-9) << "quantity " << i;
    EXPECT_LT(fine[0], 2e-3);
  }
}

TEST(finder, turning_about_the_normal_keeps_the_axes_of_the_world) {
  rig r = box_on_plate(cut_into::flat_faces);
  vec3 u(0.0);
  for (int k = 0; k <= 1000; ++k) {
    const pose T{exp_rotation({0.0, 0.0, 2e-3 * k}), {0.0, 0.0, 0.0299}};
    ASSERT_EQ(r.at(T), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    EXPECT_EQ(r.only().id, 0U);
    if (k > 0) {
      EXPECT_LT(glm::distance(r.only().window.u_w, u), 1e-9);
    }
    u = r.only().window.u_w;
  }
}

TEST(finder, a_box_in_an_inner_corner_has_one_contact_per_wall) {
  const coarse_mesh l =
      test::prism_mesh({{0.08, -0.02}, {0.08, 0.02}, {0.02, 0.02}, {0.02, 0.08}, {-0.02, 0.08}, {-0.02, -0.02}}, 0.05);
  for (const cut_into how : {cut_into::triangles, cut_into::flat_faces}) {
    rig r(make_piece_model(box_mesh(vec3(0.01)), how), make_piece_model(l, cut_into::triangles));
    const pose T{{1.0, 0.0, 0.0, 0.0}, {0.0299, 0.02995, 0.0}};
    ASSERT_EQ(r.at(T), status::ok);
    ASSERT_EQ(r.out.size(), 2U);
    expect_sound(r, T);
    double x = 0.0, y = 0.0;
    for (const contact& c : r.out.contacts()) {
      x = std::min(x, c.window.n_ab_w.x);
      y = std::min(y, c.window.n_ab_w.y);
    }
    EXPECT_NEAR(x, -1.0, 1e-6);
    EXPECT_NEAR(y, -1.0, 1e-6);
  }
}

TEST(finder, two_feet_apart_are_two_contacts) {
  coarse_mesh feet;
  for (const double x : {-0.03, 0.03}) {
    const auto first = static_cast<std::uint32_t>(feet.positions.size());
    const coarse_mesh foot = box_mesh({0.005, 0.005, 0.02});
    for (const vec3& p : foot.positions) feet.positions.push_back(p + vec3(x, 0.0, 0.0));
    for (coarse_triangle t : foot.triangles) {
      for (std::uint32_t& v : t.vertex) v += first;
      feet.triangles.push_back(t);
    }
  }
  for (const cut_into how : {cut_into::triangles, cut_into::flat_faces}) {
    rig r(make_piece_model(feet, how), make_piece_model(box_mesh({0.1, 0.1, 0.01}), cut_into::flat_faces));
    const pose T{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0299}};
    ASSERT_EQ(r.at(T), status::ok);
    ASSERT_EQ(r.out.size(), 2U);
    expect_sound(r, T);
    for (const contact& c : r.out.contacts()) {
      EXPECT_NEAR(c.window.n_ab_w.z, -1.0, 1e-9);
      EXPECT_NEAR(std::fabs(c.window.centre_w.x), 0.03, 1e-6);
      EXPECT_NEAR(c.window.half_size_m, 1.05 * 0.005, 1e-6);
      EXPECT_EQ(c.count_a, 2U);
    }
  }
}

TEST(finder, a_block_on_a_gear_is_one_contact_along_the_line) {
  rig r(make_piece_model(box_mesh({0.02, 0.02, 0.02}), cut_into::one_piece),
        make_piece_model(test::prism_mesh(test::regular_polygon(400, 0.05), 0.02), cut_into::one_piece));
  for (int k = 0; k < 300; ++k) {
    const pose T{{1.0, 0.0, 0.0, 0.0}, {2e-5 * k, 0.07 - 1e-4, 0.003}};
    ASSERT_EQ(r.at(T), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    const contact& c = r.only();
    EXPECT_EQ(c.id, 0U);
    EXPECT_LT(c.window.n_ab_w.y, -0.999);
    EXPECT_NEAR(c.separation_m, -1e-4, 2e-5);
    EXPECT_NEAR(c.window.centre_w.z, 0.0015, 1e-6);  // the common length of both: -0.017 to 0.02
    EXPECT_GE(c.window.half_size_m, 0.0185);
    EXPECT_LE(c.window.half_size_m, 0.021);
  }
}

TEST(finder, a_pair_at_the_tolerance_weighs_nothing) {
  window_finder_settings settings;
  settings.tolerance_m = 1e-3;
  EXPECT_EQ(separation_weight(1e-3, 1e-3), 0.0);
  EXPECT_LT(separation_weight(1e-3 - 1e-9, 1e-3), 1e-11);
  EXPECT_EQ(separation_weight(2e-3, 1e-3), 0.0);
  EXPECT_EQ(separation_weight(0.0, 1e-3), 1.0);
  EXPECT_GT(separation_weight(-1e-3, 1e-3), separation_weight(0.0, 1e-3));
  for (const cut_into how : every_cut) {
    rig r = box_on_plate(how, settings);
    EXPECT_EQ(r.at({{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.03 + 1.0001e-3}}), status::ok);
    EXPECT_EQ(r.out.size(), 0U);
    EXPECT_EQ(r.at({{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.03 + 0.9999e-3}}), status::ok);
    EXPECT_EQ(r.out.size(), 1U);
  }
}

TEST(finder, a_new_contact_has_its_whole_window_at_once) {
  // One pair, off the middle of both boxes' overlap, a hair inside the tolerance: still the place where they touch.
  for (const cut_into how : every_cut) {
    window_finder_settings settings;
    settings.tolerance_m = 1e-3;
    rig r = box_on_plate(how, settings);
    const double corner = 0.02 * std::sqrt(3.0);
    const quat tip =
        exp_rotation({0.0, std::asin(1.0 / std::sqrt(3.0)), 0.0}) * exp_rotation({std::acos(std::sqrt(0.5)), 0.0, 0.0});
    const pose T{exp_rotation({0.3, 0.1, 0.0}) * tip, {0.02, -0.01, 0.01}};
    double lowest = 0.0;
    for (const vec3& p : r.bodies.probe->mesh.positions) lowest = std::min(lowest, (T.rotation * p).z);
    EXPECT_LT(-lowest, corner);
    const pose near{T.rotation, T.position + vec3(0.0, 0.0, 0.99999e-3 - lowest)};
    ASSERT_EQ(r.at(near), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    expect_sound(r, near);
    EXPECT_LT(glm::distance(r.only().window.centre_w, 0.5 * (r.only().p_a_w + r.only().p_b_w)), 1e-3);
    EXPECT_NEAR(r.only().separation_m, 1e-3, 1e-4);
  }
}

TEST(finder, a_new_contact_of_whole_convex_bodies_lies_on_their_common_line) {
  // Both boxes are far larger than the place of contact, so the middle of what they share says little about it.
  rig r(make_piece_model(box_mesh({0.02, 0.02, 0.02}), cut_into::one_piece),
        make_piece_model(test::prism_mesh(test::regular_polygon(400, 0.05), 0.02), cut_into::one_piece));
  const double tolerance = r.finder.settings(0).tolerance_m;
  const vec3 out(std::sin(0.6), std::cos(0.6), 0.0);
  const pose T{exp_rotation({0.0, 0.0, -0.6}), (0.07 + 0.98 * tolerance) * out + vec3(0.0, 0.0, 0.003)};
  ASSERT_EQ(r.at(T), status::ok);
  ASSERT_EQ(r.out.size(), 1U);
  expect_sound(r, T);
  EXPECT_LT(glm::distance(vec2(r.only().window.centre_w), 0.05 * vec2(out)), 1e-3);
  EXPECT_NEAR(r.only().window.centre_w.z, 0.0015, 1e-3);
  EXPECT_GE(r.only().window.half_size_m, 0.018);
}

TEST(finder, a_round_probe_of_triangles_is_followed_deeper_than_the_tolerance) {
  // Far below the plate's top, no triangle of the probe's lowest part is near the plate's surface any more.
  rig r(make_piece_model(test::torus_mesh(0.03, 0.01, 24, 16), cut_into::triangles),
        make_piece_model(box_mesh({0.05, 0.05, 0.02}, 2), cut_into::flat_faces));
  const quat upright = exp_rotation({std::acos(0.0), 0.0, 0.0});
  double lowest = 0.0;
  for (const vec3& p : r.bodies.probe->mesh.positions) lowest = std::min(lowest, (upright * p).z);
  ASSERT_LT(r.finder.settings(0).tolerance_m, 1e-3);
  for (const double depth : {1e-4, 1e-3, 2e-3, 4e-3}) {
    const pose T{upright, {0.003, 0.002, 0.02 - lowest - depth}};
    ASSERT_EQ(r.at(T), status::ok);
    ASSERT_EQ(r.out.size(), 1U) << "depth " << depth;
    expect_sound(r, T);
    EXPECT_LT(r.only().window.n_ab_w.z, -0.99);
    EXPECT_NEAR(r.only().separation_m, -depth, 0.1 * depth + 1e-4);
  }
  EXPECT_GT(r.finder.statistics().deep_pairs, 0U);
}

TEST(finder, the_axes_do_not_spin_while_the_normal_turns) {
  // Both bodies turn together: the axis that any_orthogonal would choose changes on the way.
  rig r = box_on_plate(cut_into::flat_faces);
  contact_window last;
  for (int k = 0; k <= 1000; ++k) {
    const pose turn{exp_rotation({2e-3 * k, 1e-3 * k, 0.0}), vec3(0.0)};
    r.T_wb[0] = turn;
    ASSERT_EQ(r.at(turn * pose{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0299}}), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    EXPECT_EQ(r.only().id, 0U);
    if (k > 0) {
      EXPECT_LT(glm::distance(r.only().window.u_w, last.u_w), 4e-3) << "tick " << k;
    }
    last = r.only().window;
  }
}

TEST(finder, a_thin_plate_pushes_out_on_the_side_that_was_entered) {
  // The plate's lower side is within reach of the probe's bottom; it must not pull the probe through.
  for (const cut_into how : every_cut) {
    rig r(make_piece_model(box_mesh({0.02, 0.02, 0.02}), how), make_piece_model(box_mesh({0.05, 0.05, 0.0005}), how));
    for (const double depth : {-1e-4, 1e-4, 5e-4, 9e-4}) {
      const pose T{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0205 - depth}};
      ASSERT_EQ(r.at(T), status::ok);
      ASSERT_EQ(r.out.size(), 1U) << "depth " << depth;
      expect_sound(r, T);
      EXPECT_NEAR(r.only().window.n_ab_w.z, -1.0, 1e-9);
      EXPECT_NEAR(r.only().separation_m, -depth, 1e-9);
      EXPECT_EQ(r.only().count_b, 2U);  // the top, not the bottom
    }
  }
}

TEST(finder, deeper_than_the_limit_the_last_direction_is_held) {
  window_finder_settings settings;
  settings.max_depth_m = 1e-3;
  const pose above{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0302 - 1e-3}};
  const pose below{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0298 - 1e-3}};
  for (const cut_into how : every_cut) {
    rig r = box_on_plate(how, settings);
    EXPECT_EQ(r.at(below), status::ok);
    EXPECT_EQ(r.out.size(), 0U);  // no direction was ever valid
    EXPECT_EQ(r.at(above), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    EXPECT_FALSE(r.only().held);
    const contact last = r.only();
    EXPECT_EQ(r.at(below), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    expect_sound(r, below);
    EXPECT_TRUE(r.only().held);
    EXPECT_EQ(r.only().id, last.id);
    EXPECT_NEAR(glm::distance(r.only().window.n_ab_w, last.window.n_ab_w), 0.0, 1e-9);
    EXPECT_NEAR(r.only().separation_m, -1.2e-3, 1e-9);
    EXPECT_NEAR(r.only().window.half_size_m, last.window.half_size_m, 1e-9);
    EXPECT_EQ(r.finder.statistics().held_contacts, 1U);
    EXPECT_EQ(r.at(above), status::ok);
    ASSERT_EQ(r.out.size(), 1U);
    EXPECT_FALSE(r.only().held);
    EXPECT_EQ(r.only().id, last.id);
  }
}

TEST(finder, says_which_capacity_was_reached) {
  const pose T{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0299}};
  window_finder_settings few_pairs;
  few_pairs.close_pairs = 3;
  rig a = box_on_plate(cut_into::triangles, few_pairs);
  EXPECT_EQ(a.at(T), status::capacity_reached);
  EXPECT_GT(a.finder.statistics().dropped_pairs, 0U);
  EXPECT_EQ(a.out.size(), 1U);  // what fits is still used

  const coarse_mesh l =
      test::prism_mesh({{0.08, -0.02}, {0.08, 0.02}, {0.02, 0.02}, {0.02, 0.08}, {-0.02, 0.08}, {-0.02, -0.02}}, 0.05);
  const pose corner{{1.0, 0.0, 0.0, 0.0}, {0.0299, 0.02995, 0.0}};
  window_finder_settings one_cluster;
  one_cluster.clusters = 1;
  rig b(make_piece_model(box_mesh(vec3(0.01)), cut_into::triangles), make_piece_model(l, cut_into::triangles),
        one_cluster);
  EXPECT_EQ(b.at(corner), status::capacity_reached);
  EXPECT_EQ(b.finder.statistics().dropped_clusters, 1U);

  rig c(make_piece_model(box_mesh(vec3(0.01)), cut_into::triangles), make_piece_model(l, cut_into::triangles), {},
        {1, 64});
  EXPECT_EQ(c.at(corner), status::capacity_reached);
  EXPECT_EQ(c.out.dropped(), 1U);
}

TEST(finder, refuses_poses_that_it_cannot_use) {
  rig r = box_on_plate(cut_into::one_piece);
  EXPECT_EQ(r.at({{1.0, 0.0, 0.0, 0.0}, {std::nan(""), 0.0, 0.0}}), status::invalid_pose);
  EXPECT_EQ(r.out.size(), 0U);
  EXPECT_EQ(r.finder.find({pose{}, {}}, r.out), status::not_ready);
}

TEST(finder, same_history_same_bits) {
  rig first = box_on_plate(cut_into::triangles), second = box_on_plate(cut_into::triangles);
  for (int k = 0; k < 200; ++k) {
    const pose T{exp_rotation({0.05 * std::sin(0.1 * k), 0.04 * std::cos(0.07 * k), 0.01 * k}),
                 {1e-4 * k, 0.0, 0.0305}};
    ASSERT_EQ(first.at(T), second.at(T));
    ASSERT_EQ(first.out.size(), second.out.size());
    for (std::size_t i = 0; i < first.out.size(); ++i) {
      const contact& x = first.out.contacts()[i];
      const contact& y = second.out.contacts()[i];
      EXPECT_EQ(x.id, y.id);
      EXPECT_EQ(std::memcmp(&x.window, &y.window, sizeof x.window), 0);
      EXPECT_EQ(std::memcmp(&x.p_a_w, &y.p_a_w, sizeof x.p_a_w), 0);
      EXPECT_EQ(x.separation_m, y.separation_m);
    }
  }
}

TEST(finder, history_does_not_decide_who_touches) {
  rig warm = box_on_plate(cut_into::triangles);
  for (int k = 0; k < 100; ++k) {
    const pose T{exp_rotation({0.05 * std::sin(0.1 * k), 0.04 * std::cos(0.07 * k), 0.01 * k}),
                 {1e-4 * k, 0.0, 0.0305}};
    rig cold = box_on_plate(cut_into::triangles);
    ASSERT_EQ(warm.at(T), cold.at(T));
    ASSERT_EQ(warm.out.size(), cold.out.size());
    EXPECT_EQ(warm.finder.statistics().close_pairs, cold.finder.statistics().close_pairs);
    for (std::size_t i = 0; i < warm.out.size(); ++i) {
      EXPECT_NEAR(glm::distance(warm.out.contacts()[i].window.n_ab_w, cold.out.contacts()[i].window.n_ab_w), 0.0, 1e-6);
    }
  }
}

TEST(finder, does_nothing_that_a_tick_must_not_do) {
  rig r(make_piece_model(test::torus_mesh(0.05, 0.02, 12, 8), cut_into::triangles),
        make_piece_model(test::torus_mesh(0.05, 0.02, 13, 9), cut_into::triangles));
  std::size_t contacts = 0;
  test_support::tick_trap trap;
  status worst = status::ok;
  for (int k = 0; k < 100; ++k) {
    const pose T{exp_rotation({0.01 * k, 0.1, 0.02 * k}), {0.06, 1e-4 * k, 0.038 - 5e-5 * k}};
    status s = status::ok;
    trap([&] { s = r.at(T); });
    if (s != status::ok) worst = s;
    contacts += r.out.size();
  }
  EXPECT_EQ(worst, status::ok);
  EXPECT_GT(contacts, 50U);
}

}  // namespace
}  // namespace asperity
