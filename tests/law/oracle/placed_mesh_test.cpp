// The oracle of poses itself: what it says of balls has a closed form, and what it says of random meshes can be asked
// of every triangle.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <vector>

#include "law/oracle/approach.hpp"
#include "law/oracle/fresh_poses.hpp"
#include "support/fresh_seed.hpp"
#include "support/random_hulls.hpp"

namespace asperity::oracle {
namespace {

/// A ball of that many rings of triangles; its corners lie on the sphere.
triangle_mesh ball(double radius_m, int rings) {
  triangle_mesh out;
  const int around = 2 * rings;
  out.positions.emplace_back(0.0, 0.0, radius_m);
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double t = std::numbers::pi * i / rings, a = 2.0 * std::numbers::pi * j / around;
      out.positions.push_back(radius_m * vec3(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)));
    }
  }
  out.positions.emplace_back(0.0, 0.0, -radius_m);
  const auto at = [&](int i, int j) {
    if (i == 0) return std::uint32_t{0};
    if (i == rings) return static_cast<std::uint32_t>(out.positions.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * around + j % around);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      if (i + 1 < rings) out.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (i > 0) out.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return out;
}

triangle_mesh random_hull(test::uniform_source& random, double size_m, int points) {
  std::vector<vec3> at;
  for (int i = 0; i < points; ++i) at.push_back(random.in_box(size_m));
  const coarse_mesh hull = test::brute_hull(at);
  triangle_mesh out{hull.positions, {}, {}};
  for (const coarse_triangle& t : hull.triangles) out.triangles.push_back(t.vertex);
  return out;
}

coarse_mesh as_coarse(const triangle_mesh& mesh, const pose& T) {
  coarse_mesh out;
  for (const vec3& p : mesh.positions) out.positions.push_back(T * p);
  for (const auto& t : mesh.triangles) out.triangles.push_back({t, {}});
  return out;
}

constexpr double ra_m = 0.02, rb_m = 0.03;
constexpr int rings = 60;
// A facet lies below its sphere by at most this part of the radius.
const double below = 1.0 - std::cos(0.75 * std::numbers::pi / rings);

TEST(placed_mesh, balls_touch_part_and_overlap_as_their_closed_forms_say) {
  const triangle_mesh a = ball(ra_m, rings), b = ball(rb_m, rings);
  const std::uint64_t seed = test_support::fresh_seed("balls", "40 approaches");
  approach_sampler sampler("balls", a, b);
  const double slack = below * (ra_m + rb_m);
  for (std::uint64_t i = 0; i < 40; ++i) {
    const approach on = sampler.draw(seed, i);
    const vec3 offset = on.touching.position;  // of A's centre from B's
    const double height = -glm::dot(offset, on.window.n_ab_w);
    const double aside = std::sqrt(std::max(0.0, glm::dot(offset, offset) - height * height));
    ASSERT_LT(aside, ra_m + rb_m);
    const double touch = std::sqrt((ra_m + rb_m) * (ra_m + rb_m) - aside * aside);
    // Facets come later, by more the more the spheres only graze each other.
    EXPECT_LE(height, touch + 1e-12) << "approach " << i;
    const double inner = ra_m + rb_m - slack;
    if (inner > aside) {
      EXPECT_GE(height, std::sqrt(inner * inner - aside * aside) - 1e-12) << "approach " << i;
    }
    for (const double way : {-1e-3, -1e-5}) {
      const double apart = glm::length(offset + way * on.window.n_ab_w) - ra_m - rb_m;
      const double found = surface_distance(sampler.probe(), sampler.fixed(), way, 1.0);
      EXPECT_GE(found, apart - 1e-12) << "approach " << i;
      EXPECT_LE(found, -way) << "approach " << i;
      EXPECT_LE(found, std::max(0.0, apart) + slack + 1e-12) << "approach " << i;
    }
    for (const double way : {1e-5, 1e-3, 5e-3}) {
      const double overlap = ra_m + rb_m - glm::length(offset + way * on.window.n_ab_w);
      const double found = overlap_at_least(sampler.probe(), sampler.fixed(), way);
      EXPECT_LE(found, overlap + 1e-12) << "approach " << i << " way " << way;
      // At least 98 % of what the corners see, which are a facet's length apart.
      EXPECT_GE(found, 0.98 * (overlap - 2.0 * slack) - slack) << "approach " << i << " way " << way;
    }
  }
}

TEST(placed_mesh, a_bracket_holds_what_thicker_and_thinner_balls_do) {
  const triangle_mesh a = ball(ra_m, rings), b = ball(rb_m, rings);
  const std::uint64_t seed = test_support::fresh_seed("bracket", "12 approaches");
  approach_sampler sampler("bracket", a, b);
  constexpr double error_m = 2e-4;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const approach on = sampler.draw(seed, i);
    const double height = -glm::dot(on.touching.position, on.window.n_ab_w);
    const double aside2 = glm::dot(on.touching.position, on.touching.position) - height * height;
    const touch_bracket found = bracket_of(sampler.probe(), sampler.fixed(), error_m, 0.01);
    const double r = ra_m + rb_m, slack = below * r;
    const double swollen = std::sqrt((r + error_m) * (r + error_m) - aside2);
    EXPECT_GE(found.earlier_m, error_m * 0.99);
    EXPECT_LE(found.earlier_m, swollen - height + 0.05 * error_m) << "approach " << i;
    const double thin = r - slack + error_m;
    if (thin * thin > aside2) {
      EXPECT_GE(found.earlier_m, std::sqrt(thin * thin - aside2) - height - 0.05 * error_m);
    }
    EXPECT_GE(found.later_m, error_m);
    // From there on the overlap is what it was searched for.
    if (found.later_m < 0.01 / 1.3) {
      EXPECT_GT(r - glm::length(on.touching.position + found.later_m * on.window.n_ab_w), error_m);
    }
  }
}

TEST(placed_mesh, hulls_are_as_far_apart_and_as_deep_as_all_their_triangles_say) {
  const std::uint64_t seed = test_support::fresh_seed("hulls", "30 pairs");
  test::uniform_source random(test_support::seed_of(seed, "hulls"));
  for (std::uint64_t i = 0; i < 30; ++i) {
    const triangle_mesh a = random_hull(random, 0.01, 12), b = random_hull(random, 0.015, 14);
    approach_sampler sampler("hulls", a, b);
    const approach on = sampler.draw(seed, i);
    const coarse_mesh fixed = as_coarse(b, {});
    const auto probe = [&](double way) { return as_coarse(a, on.pressed(way)); };
    EXPECT_NEAR(test::brute_separation(probe(0.0), fixed), 0.0, 1e-10) << "they touch, pair " << i;
    const double way = 2e-3;
    EXPECT_NEAR(surface_distance(sampler.probe(), sampler.fixed(), -way, 1.0), test::brute_distance(probe(-way), fixed),
                1e-12)
        << "pair " << i;
    const double least = -test::brute_separation(probe(way), fixed);
    EXPECT_GT(least, 0.0) << "pair " << i;
    EXPECT_LE(overlap_at_least(sampler.probe(), sampler.fixed(), way), least + 1e-12) << "pair " << i;
  }
}

// A line through a shared edge or corner crosses once.
TEST(placed_mesh, knows_inside_from_outside) {
  const triangle_mesh mesh = ball(0.01, 24);
  placed_mesh placed(mesh);
  const std::uint64_t seed = test_support::fresh_seed("inside", "3,000 points");
  test::uniform_source random(test_support::seed_of(seed, "inside"));
  const double slack = 0.01 * (1.0 - std::cos(0.75 * std::numbers::pi / 24));
  for (int i = 0; i < 3000; ++i) {
    const vec3 p = random.in_box(0.012);
    const double r = glm::length(p);
    if (r < 0.01 - slack) {
      ASSERT_TRUE(placed.contains(p)) << r;
      ASSERT_NEAR(placed.distance_to(p), 0.01 - r, slack);
    }
    if (r > 0.01) {
      ASSERT_FALSE(placed.contains(p)) << r;
      ASSERT_NEAR(placed.distance_to(p), r - 0.01, slack);
    }
  }
}

TEST(fresh_seed, streams_differ_and_repeat) {
  using test_support::seed_of;
  std::map<std::uint64_t, int> met;
  for (std::uint64_t seed = 20260101; seed < 20260111; ++seed) {
    for (const char* name : {"block on gear", "file on cad_part"}) {
      for (std::uint64_t i = 0; i < 100; ++i) ++met[seed_of(seed, name, i)];
    }
  }
  EXPECT_EQ(met.size(), 2000U);
  EXPECT_EQ(seed_of(1, "a", 2), seed_of(1, "a", 2));
}

TEST(known_rates, binomial_tails_are_those_of_the_tables) {
  EXPECT_NEAR(binomial_at_least(1, 10, 0.1), 0.6513215599, 1e-9);
  EXPECT_NEAR(binomial_at_most(3, 20, 0.25), 0.2251560, 1e-6);
  EXPECT_NEAR(binomial_at_least(7, 10, 0.5) + binomial_at_most(6, 10, 0.5), 1.0, 1e-12);
  EXPECT_NEAR(rate_at_most(0, 700), 1.0 - std::pow(1e-3, 1.0 / 700.0), 1e-9);
  EXPECT_NEAR(binomial_at_least(35, 700, rate_at_least(35, 700)), 1e-3, 1e-8);
  EXPECT_EQ(rate_at_least(0, 700), 0.0);
}

// A rate that has trebled is seen, one that has gone is seen, and a hundred fresh days of the same rate are not.
TEST(known_rates, tell_worse_and_better_from_chance) {
  const known_pair known{"a", "b", 700, {{formulation::least_motion, press::deep, verdict::shallow, 210}}, 0, 0, 0.0};
  const auto said = [&](std::uint64_t shallow, std::uint64_t missed) {
    tally t;
    t.approaches = 60;
    auto& row = t.of[0][static_cast<std::size_t>(press::deep)];
    row[static_cast<std::size_t>(verdict::shallow)] = shallow;
    row[static_cast<std::size_t>(verdict::missed)] = missed;
    return unexplained(counts(t, known)).size();
  };
  EXPECT_EQ(said(18, 0), 0U);
  EXPECT_EQ(said(54, 0), 1U) << "three times as often";
  EXPECT_EQ(said(0, 0), 1U) << "mended";
  EXPECT_EQ(said(18, 1), 0U) << "one may have been missed before too";
  EXPECT_EQ(said(18, 9), 1U) << "one in seven missed";
  std::mt19937_64 bits(1);
  for (int day = 0; day < 100; ++day) {
    std::uint64_t k = 0;
    for (int i = 0; i < 60; ++i) k += bits() % 10 < 3 ? 1U : 0U;
    EXPECT_EQ(said(k, 0), 0U) << k;
  }
}

}  // namespace
}  // namespace asperity::oracle
