#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include <asperity/control/plane_selection.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_bodies.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

/// All planes of a body at one probe pose.
std::vector<support_plane> reported(plane_body body, const pose& T_wa) {
  tick out;
  EXPECT_EQ(body.step({T_wa, {}}, out), status::ok);
  return {out.planes.begin(), out.planes.end()};
}

template <class Planes>
double depth_after(const Planes& planes, const vec6& moved) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const support_plane& p : planes) deepest = std::max(deepest, p.depth_m + dot(p.gradient, moved));
  return deepest;
}

// What a face of 25 or 441 points does under any tilt and slide up to what the selection was made for, the kept planes
// do to within a part of the tilt's own effect.
TEST(plane_selection, stands_for_a_face_under_every_small_motion) {
  drawn d(seed_of(fresh_seed("plane_selection", "200 poses"), "faces"));
  double worst_m = 0.0;
  double worst_of_one_m = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    plane_body block = block_on_plane();
    if (trial % 2 == 1) block.points_c = lower_face(0.01, 0.01, 0.01, 21);
    const vec3 tilt = 0.02 * vec3(d.between(0.0, 1.0) - 0.5, d.between(0.0, 1.0) - 0.5, d.between(0.0, 1.0) - 0.5);
    const auto all = reported(block, {exp_rotation(tilt), {0, 0, 0.01 - 2e-4 * d.between(0.0, 1.0)}});
    const plane_selection s;
    support_planes kept;
    ASSERT_EQ(select_planes(all, s, kept), status::ok);
    const std::vector<support_plane> one{
        *std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; })};
    for (int i = 0; i < 50; ++i) {
      const double angle = 6.283185307179586 * d.between(0.0, 1.0);
      const vec3 across{std::cos(angle), std::sin(angle), 0.0};
      const vec6 moved{s.slide_m * d.between(0.0, 1.0) * across, 8.0 * s.tilt_rad * d.between(0.0, 1.0) * across};
      const double truth = depth_after(all, moved);
      EXPECT_LE(depth_after(kept, moved), truth + 1e-15);
      worst_m = std::max(worst_m, truth - depth_after(kept, moved));
      worst_of_one_m = std::max(worst_of_one_m, truth - depth_after(one, moved));
    }
  }
  std::printf("  the planes kept were at most %.4f mm short of the face, the deepest alone %.2f mm\n", 1e3 * worst_m,
              1e3 * worst_of_one_m);
  EXPECT_LT(worst_m, 1e-5);
  EXPECT_GT(worst_of_one_m, 5e-4);
}

// For each motion that it tries it has the plane that all candidates together have, where the list was not full.
TEST(plane_selection, keeps_the_first_plane_of_every_motion) {
  drawn d(seed_of(fresh_seed("plane_selection_motions", "300 bodies"), "motions"));
  int full = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<support_plane> all;
    const vec3 n{0, 0, -1};
    const auto count = static_cast<int>(1.0 + 300.0 * d.between(0.0, 1.0));
    for (int i = 0; i < count; ++i) {
      const vec3 slope = n + 0.5 * vec3(d.between(0.0, 1.0) - 0.5, d.between(0.0, 1.0) - 0.5, 0.0);
      const vec3 r{0.05 * (d.between(0.0, 1.0) - 0.5), 0.05 * (d.between(0.0, 1.0) - 0.5), -0.01};
      all.push_back({.depth_m = 1e-4 * (d.between(0.0, 1.0) - 0.9),
                     .gradient = {slope, glm::cross(r, slope)},
                     .n_ab_w = n,
                     .r_w = r});
    }
    const plane_selection s = selection_for(static_cast<std::int64_t>(250'000 + 5e6 * d.between(0.0, 1.0)));
    support_planes kept;
    const status answer = select_planes(all, s, kept);
    full += answer == status::capacity_reached ? 1 : 0;
    const vec3 u = any_orthogonal(n);
    const vec3 w = glm::cross(n, u);
    std::vector<vec6> motions{{}};
    for (int i = 0; i < 8; ++i) {
      const vec3 way = std::cos(0.78539816339744831 * i) * u + std::sin(0.78539816339744831 * i) * w;
      motions.push_back({vec3(0.0), s.tilt_rad * way});
      motions.push_back({vec3(0.0), 8.0 * s.tilt_rad * way});
      motions.push_back({s.slide_m * way, vec3(0.0)});
    }
    EXPECT_EQ(depth_after(kept, {}), depth_after(all, {}));
    if (answer == status::capacity_reached) continue;
    for (const vec6& m : motions) EXPECT_NEAR(depth_after(kept, m), depth_after(all, m), 1e-15);
  }
  EXPECT_GT(300 - full, 30);
}

// Three walls, two bodies: nobody's direction is crowded out by a face with many points.
TEST(plane_selection, keeps_every_direction_of_every_body) {
  plane_body corner = ball_in_corner(0.005);
  corner.points_c = lower_face(0.01, 0.01, 0.01, 9);
  auto all = reported(corner, {quat(1, 0, 0, 0), {0.015, 0.015, 0.015}});
  for (std::size_t i = 0, n = all.size(); i < n; ++i) {
    all.push_back(all[i]);
    all.back().body = 1;
    all.back().depth_m -= 1e-3;
  }
  support_planes kept;
  static_cast<void>(select_planes(all, {}, kept));
  for (std::uint32_t body : {0U, 1U}) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_TRUE(std::any_of(kept.begin(), kept.end(),
                              [&](const support_plane& p) { return p.body == body && p.n_ab_w[axis] < -0.9; }))
          << body << ' ' << axis;
    }
  }
}

TEST(plane_selection, says_when_its_list_was_full) {
  drawn d(7);
  std::vector<support_plane> all;  // forty directions
  for (int i = 0; i < 40; ++i) {
    const vec3 n =
        glm::normalize(vec3(d.between(0.0, 1.0) - 0.5, d.between(0.0, 1.0) - 0.5, d.between(0.0, 1.0) - 0.5));
    all.push_back({.depth_m = -1e-6 * i, .gradient = {n, vec3(0.0)}, .n_ab_w = n, .body = static_cast<unsigned>(i)});
  }
  support_planes kept;
  EXPECT_EQ(select_planes(all, {}, kept), status::capacity_reached);
  EXPECT_EQ(kept.size(), most_selected_planes);
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(kept[i].body, i);  // the deepest, in order
  all.resize(3);
  EXPECT_EQ(select_planes(all, {}, kept), status::ok);
  EXPECT_EQ(kept.size(), 3U);
  EXPECT_EQ(select_planes({}, {}, kept), status::ok);
  EXPECT_TRUE(kept.empty());
}

TEST(plane_selection, keeps_gaps) {
  const auto all = reported(block_on_plane(), {quat(1, 0, 0, 0), {0, 0, 0.013}});
  support_planes kept;
  ASSERT_EQ(select_planes(all, {}, kept), status::ok);
  EXPECT_GE(kept.size(), 4U);
  for (const support_plane& p : kept) EXPECT_NEAR(p.depth_m, -0.003, 1e-15);
}

TEST(plane_selection, refuses_candidates_that_are_not_finite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int where = 0; where < 14; ++where) {
      auto all = reported(block_on_plane(), {quat(1, 0, 0, 0), {0, 0, 0.01}});
      support_plane& p = all[3];
      if (where == 0) p.depth_m = bad;
      if (where == 1) p.spread_m = bad;
      if (where >= 2 && where < 8) p.gradient[static_cast<std::size_t>(where - 2)] = bad;
      if (where >= 8 && where < 11) p.n_ab_w[where - 8] = bad;
      if (where >= 11) p.r_w[where - 11] = bad;
      support_planes kept;
      EXPECT_EQ(select_planes(all, {}, kept), status::not_finite) << where;
      EXPECT_TRUE(kept.empty());
    }
  }
}

TEST(plane_selection, fits_its_period) {
  EXPECT_DOUBLE_EQ(selection_for(1'000'000).tilt_rad, plane_selection{}.tilt_rad);
  EXPECT_DOUBLE_EQ(selection_for(1'000'000).slide_m, plane_selection{}.slide_m);
  EXPECT_DOUBLE_EQ(selection_for(5'000'000).tilt_rad, 0.025);
  EXPECT_DOUBLE_EQ(selection_for(5'000'000).slide_m, 5e-4);
  EXPECT_TRUE(check(plane_selection{}).has_value());
  EXPECT_FALSE(check(plane_selection{.tilt_rad = 0.0}).has_value());
  EXPECT_FALSE(check(plane_selection{.tilt_rad = 1.0}).has_value());
  EXPECT_FALSE(check(plane_selection{.slide_m = -1.0}).has_value());
  EXPECT_FALSE(check(plane_selection{.same_direction = 1.0}).has_value());
}

}  // namespace
