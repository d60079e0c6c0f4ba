// Balls and boxes of known overlap: each rival has to report it within its own resolution, and so has the truth that
// all are judged by.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "asperity/core/spatial.hpp"
#include "contender.hpp"
#include "originals.hpp"
#include "race.hpp"
#include "support/fresh_seed.hpp"
#include "touching_path.hpp"

namespace asperity::rivals {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// A cube's six faces cut into squares of two triangles, each point moved by `bend`.
triangle_mesh bent_cube(std::uint32_t cuts, const std::function<vec3(const vec3&)>& bend) {
  triangle_mesh out;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<std::uint32_t, 3> at) {
    const auto [found, fresh] = known.emplace(at, static_cast<std::uint32_t>(out.positions.size()));
    if (fresh) out.positions.push_back(bend(2.0 * vec3(at[0], at[1], at[2]) / static_cast<double>(cuts) - 1.0));
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool high : {false, true}) {
      for (std::uint32_t i = 0; i < cuts; ++i) {
        for (std::uint32_t j = 0; j < cuts; ++j) {
          const auto at = [&](std::uint32_t u, std::uint32_t v) {
            std::array<std::uint32_t, 3> c{};
            c[axis] = high ? cuts : 0;
            c[(axis + 1) % 3] = u;
            c[(axis + 2) % 3] = v;
            return vertex(c);
          };
          std::array<std::uint32_t, 4> q{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (!high) std::swap(q[1], q[3]);
          out.triangles.push_back({q[0], q[1], q[2]});
          out.triangles.push_back({q[0], q[2], q[3]});
        }
      }
    }
  }
  return out;
}

triangle_mesh ball(double radius_m) {
  return bent_cube(80, [=](const vec3& p) { return radius_m * glm::normalize(p); });
}
triangle_mesh box(const vec3& half_m) {
  return bent_cube(20, [=](const vec3& p) { return half_m * p; });
}

constexpr double small_m = 0.02, large_m = 0.03;  // radii of balls

/// Two bodies in a known overlap.
struct known_overlap {
  body_pair bodies;
  pose T_wa;
  double depth_m;
  vec3 n_ab_w;
};

/// A ball over a ball, pressed along a direction within `aside_rad` of straight down.
known_overlap pressed_balls(double depth_m, double aside_rad, std::mt19937_64& bits) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const double across = std::sin(aside_rad * share(bits)), angle = 2.0 * std::numbers::pi * share(bits);
  const vec3 n(across * std::cos(angle), across * std::sin(angle), -std::sqrt(1.0 - across * across));
  const vec3 turn = 3.0 * vec3(share(bits), share(bits), share(bits));
  return {{"balls", ball(small_m), ball(large_m), {}},
          {exp_rotation(turn), -(small_m + large_m - depth_m) * n},
          depth_m,
          n};
}

/// A box flat on a larger one, turned about the vertical. The sides are so long that up is the shortest way out.
known_overlap stacked_boxes(double depth_m, std::mt19937_64& bits) {
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const vec3 half_a(0.012, 0.01, 0.008), half_b(0.03, 0.035, 0.01);
  return {{"boxes", box(half_a), box(half_b), {}},
          {exp_rotation({0.0, 0.0, 3.0 * share(bits)}),
           {0.005 * share(bits), 0.005 * share(bits), half_a.z + half_b.z - depth_m}},
          depth_m,
          {0.0, 0.0, -1.0}};
}

std::uint64_t seed() { return test_support::fresh_seed("rivals", "3 overlaps of balls, 3 of boxes"); }

/// What the facets of both balls may hide of their overlap: the sagitta of the longest edge, doubled for its diagonal.
double facets_m() {
  const auto sagitta = [](double r) {
    const double edge = 1.6 * r * std::numbers::pi / 2.0 / 80.0;
    return edge * edge / (4.0 * r);
  };
  return sagitta(small_m) + sagitta(large_m);
}

TEST(rivals_truth, parts_balls_as_their_radii_say) {
  std::mt19937_64 bits(seed());
  for (const double depth_m : {5e-5, 2e-4, 1e-3}) {
    const known_overlap known = pressed_balls(depth_m, 0.6, bits);
    originals truth(known.bodies.probe, known.bodies.fixed);
    const parting found = truth.part(known.T_wa, 2.0 * depth_m);
    EXPECT_NEAR(found.depth_m, depth_m, facets_m());
    EXPECT_LE(found.at_least_m, found.depth_m + 1e-12);
    EXPECT_GE(found.at_least_m, 0.96 * depth_m - facets_m());
    // A facet's normal may be half of what a facet turns by off the ball's.
    EXPECT_GE(glm::dot(found.n_ab_w, known.n_ab_w), std::cos(1.5 * degree));
    EXPECT_FALSE(truth.cross(known.T_wa, -1.0001 * found.depth_m * found.n_ab_w));
    EXPECT_TRUE(truth.cross(known.T_wa, -0.98 * found.at_least_m * found.n_ab_w));
  }
}

TEST(rivals_truth, parts_boxes_exactly) {
  std::mt19937_64 bits(seed());
  for (const double depth_m : {5e-5, 1e-3}) {
    const known_overlap known = stacked_boxes(depth_m, bits);
    originals truth(known.bodies.probe, known.bodies.fixed);
    const parting found = truth.part(known.T_wa, depth_m * (1.0 + 1e-9));
    EXPECT_NEAR(found.depth_m, depth_m, 1e-12);
    EXPECT_GE(glm::dot(found.n_ab_w, known.n_ab_w), std::cos(1e-3 * degree));
    EXPECT_GT(found.elsewhere_m, 1.1 * depth_m);
  }
}

TEST(rivals_truth, path_presses_as_deep_as_it_says) {
  const body_pair bodies{"balls", ball(small_m), ball(large_m), {}};
  originals truth(bodies.probe, bodies.fixed);
  const auto path = make_touching_path(truth, bodies.probe, bodies.fixed, 20, seed());
  ASSERT_EQ(path.size(), 20U);
  for (const pressed_pose& p : path) {
    EXPECT_NEAR(truth.way_down_m(p.T_wa), -p.press_m, 1e-12);
    EXPECT_GT(p.press_m, 0.0);
    EXPECT_LE(p.press_m, most_press_m);
    EXPECT_TRUE(truth.cross(p.T_wa, vec3(0.0)));
    // Between balls the shortest way out is along the line of centres.
    const vec3 between = p.T_wa.position;
    const double overlap_m = small_m + large_m - glm::length(between);
    EXPECT_NEAR(truth.part(p.T_wa, p.press_m).depth_m, overlap_m, facets_m() + 0.01 * overlap_m);
  }
}

TEST(rivals_truth, apart_is_apart) {
  std::mt19937_64 bits(seed());
  known_overlap known = pressed_balls(1e-4, 0.6, bits);
  known.T_wa.position *= 1.01;
  originals truth(known.bodies.probe, known.bodies.fixed);
  EXPECT_EQ(truth.part(known.T_wa, 1e-3).depth_m, 0.0);
}

/// A rival and what it resolves. A pair of triangles knows nothing of what lies deeper: of a mesh on a mesh only a
/// bound
/// is known.
struct known_rival {
  const char* name;
  std::function<result<contender_ptr>(const body_pair&)> make;
  bool reports_depth;
  double resolution_m;
  double direction_rad;
};
void PrintTo(const known_rival& r, std::ostream* to) { *to << r.name; }

class rivals_test : public testing::TestWithParam<known_rival> {};

void expect_known(const known_rival& rival, contender& feels, const known_overlap& known) {
  const felt found = feels.feel(known.T_wa);
  EXPECT_TRUE(found.touches);
  EXPECT_GT(found.contacts, 0U);
  EXPECT_LE(found.depth_m, known.depth_m + rival.resolution_m);
  if (rival.reports_depth) {
    EXPECT_GE(found.depth_m, known.depth_m - rival.resolution_m);
  }
  ASSERT_GT(glm::length(found.force_w), 0.0);
  const double along = -glm::dot(glm::normalize(found.force_w), known.n_ab_w);
  EXPECT_GE(along, std::cos(rival.direction_rad))
      << "force off by " << std::acos(std::clamp(along, -1.0, 1.0)) / degree << " degrees";
  pose away = known.T_wa;
  away.position -= (known.depth_m + 2.0 * rival.resolution_m) * known.n_ab_w;
  EXPECT_FALSE(feels.feel(away).touches);
  // And again as before: nothing is left of a pose.
  EXPECT_EQ(feels.feel(known.T_wa).depth_m, found.depth_m);
}

TEST_P(rivals_test, reports_known_overlaps) {
  std::mt19937_64 bits(seed());
  const auto press = [&](const std::string& name, const auto& draw) {
    SCOPED_TRACE(name);
    const body_pair bodies = draw(1e-3).bodies;
    const auto made = GetParam().make(bodies);
    ASSERT_TRUE(made) << made.error().message;
    for (const double depth_m : {2e-4, 5e-4, 1e-3}) expect_known(GetParam(), **made, draw(depth_m));
  };
  press("balls", [&](double depth_m) { return pressed_balls(depth_m, 0.6, bits); });
  press("boxes", [&](double depth_m) { return stacked_boxes(depth_m, bits); });
}

INSTANTIATE_TEST_SUITE_P(each, rivals_test,
                         testing::Values(known_rival{"fcl", make_fcl, false, 5e-6, 5.0 * degree},
                                         known_rival{"gimpact", make_gimpact, false, 5e-6, 5.0 * degree},
                                         known_rival{"point_shell",
                                                     [](const body_pair& b) { return make_point_shell(b, 0.004); },
                                                     true, 5e-5, 5.0 * degree},
                                         known_rival{"mujoco", make_mujoco, true, 2e-5, 2.0 * degree}),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(rivals_race, judges_every_contender_by_the_same_truth) {
  const body_pair bodies{"balls", ball(small_m), ball(large_m), {}};
  /// Tells half the truth, sideways.
  struct liar final : contender {
    felt feel(const pose& T_wa) override {
      return {true, 0.5 * (small_m + large_m - glm::length(T_wa.position)), vec3(1.0, 0.0, 0.0), 1};
    }
  };
  const std::vector<entry> entries{
      {"point shell", false, [](const body_pair& b) { return make_point_shell(b, 0.004); }},
      {"liar", false, [](const body_pair&) { return result<contender_ptr>(std::make_unique<liar>()); }},
      {"none", false, [](const body_pair&) {
         return result<contender_ptr>(error{error_code::bad_mesh, "no"});
       }}};
  const auto run = run_race(bodies, entries, {.poses = 40, .judged = 10, .seed = seed()},
                            [](std::string_view, double) { return true; });
  ASSERT_TRUE(run) << run.error().message;
  ASSERT_EQ(run->outcomes.size(), 3U);
  ASSERT_EQ(run->judged.size(), 10U);
  const outcome &shell = run->outcomes[0], &lies = run->outcomes[1];
  EXPECT_EQ(shell.seconds.size(), run->poses);
  EXPECT_GT(shell.memory_bytes, 1'000'000U);
  ASSERT_EQ(shell.depth_error_m.size(), 10U);
  for (const double e : shell.depth_error_m) EXPECT_LT(std::fabs(e), 5e-5);
  ASSERT_EQ(lies.depth_error_m.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(lies.depth_error_m[i], -0.5 * run->judged[i].truth.depth_m, 2e-5);
    EXPECT_GE(lies.outside_m[i], 0.0);
  }
  for (const double turned : lies.turned_rad) EXPECT_GT(turned, 45.0 * degree);
  EXPECT_EQ(run->outcomes[2].fault, "no");
}

}  // namespace
}  // namespace asperity::rivals
