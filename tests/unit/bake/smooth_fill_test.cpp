// Holes in smooth surfaces are closed smoothly, those that end in an edge as they always were.
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

#include "asperity/bake/repair.hpp"
#include "bake/check.hpp"
#include "bake/triangle_bvh.hpp"
#include "dirty_mesh.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

/// A closed surface, and how wide a hole it can have.
struct subject {
  const char* name;
  triangle_mesh mesh;
  double size_m;
};

triangle_mesh bumpy_ball(shapes::dice& dice) {
  triangle_mesh out =
      dirt::ball(static_cast<std::uint32_t>(50 + dice.below(20)), static_cast<std::uint32_t>(80 + dice.below(40)));
  const double phase = dice(0.0, 6.0);
  for (vec3& p : out.positions) {
    const vec3 q = 60.0 * p;
    p *= 1.0 + 0.1 * std::sin(q.x + phase) * std::sin(q.y + 2.0 * phase) * std::sin(q.z + 3.0 * phase);
  }
  return out;
}

subject draw_subject(std::size_t run, shapes::dice& dice) {
  const auto some = [&](std::size_t least, std::size_t more) {
    return static_cast<std::uint32_t>(least + dice.below(more));
  };
  if (run % 3 == 0) return {"ball", dirt::ball(some(20, 40), some(30, 50)), 0.05};
  if (run % 3 == 1) {
    shapes::wavy_torus torus;
    torus.amplitude_m = 0.0;
    return {"torus", torus.mesh(some(60, 60), some(28, 30)), torus.minor_m};
  }
  return {"bumpy ball", bumpy_ball(dice), 0.05};
}

/// Without the triangles around a point of the surface.
triangle_mesh with_hole(const triangle_mesh& mesh, const vec3& at, double radius_m) {
  triangle_mesh out = mesh;
  std::erase_if(out.triangles, [&](const auto& t) {
    return glm::length((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0 - at) < radius_m;
  });
  return out;
}

/// How far the vertices of the surface are from what was made of it, RMS.
double rms_distance(const triangle_mesh& surface, const triangle_mesh& made) {
  const triangle_bvh tree(made.positions, made.triangles);
  double sum = 0.0;
  for (const vec3& p : surface.positions) sum += std::pow(tree.closest(p).distance_m, 2);
  return std::sqrt(sum / static_cast<double>(surface.positions.size()));
}

/// How far what was made strays from the surface at most.
double farthest(const triangle_mesh& made, const triangle_mesh& surface) {
  const triangle_bvh tree(surface.positions, surface.triangles);
  double out = 0.0;
  for (const vec3& p : made.positions) out = std::max(out, tree.closest(p).distance_m);
  return out;
}

repair_settings flat_only() {
  repair_settings out;
  out.smooth_holes = false;
  return out;
}

// Measured on 3,000 draws (seed 77), ball, torus and bumpy ball: RMS distance 0.085, 0.113 and 0.132 of the flat patches',
// wrong volume 0.078, 0.073 and 0.109 of theirs, and 1,000, 976 and 956 of 1,000 holes were closed smoothly.
TEST(SmoothFill, ComesNearerToTheSurfaceThanAFlatPatch) {
  const auto runs = test_support::extent<std::size_t>(60, 1000);
  shapes::dice dice(test_support::fresh_seed("smooth fill, holes", "60 or 1,000 holes"));
  struct sums {
    double flat_rms = 0.0, smooth_rms = 0.0, flat_volume = 0.0, smooth_volume = 0.0;
    std::size_t smooth = 0, all = 0;
  };
  std::array<sums, 3> of_kind;
  for (std::size_t run = 0; run < runs; ++run) {
    const subject s = draw_subject(run, dice);
    const vec3 at = s.mesh.positions[s.mesh.triangles[dice.below(s.mesh.triangles.size())][0]];
    const double radius = s.size_m * dice(0.4, 0.8);
    SCOPED_TRACE("run " + std::to_string(run) + ", " + s.name);
    triangle_mesh flat = with_hole(s.mesh, at, radius);
    triangle_mesh smooth = flat;
    ASSERT_TRUE(repair(flat, flat_only()));
    const auto report = repair(smooth);
    ASSERT_TRUE(report) << report.error().message;
    ASSERT_TRUE(check(smooth));
    EXPECT_EQ((*report)[repair_kind::crossing].count, 0U);
    EXPECT_EQ(report->triangles_after, smooth.triangles.size());
    EXPECT_LE(report->made_up_share, repair_settings{}.largest_made_up_share);
    const double volume = dirt::volume(s.mesh);
    const double flat_rms = rms_distance(s.mesh, flat), smooth_rms = rms_distance(s.mesh, smooth);
    sums& kind = of_kind[run % 3];
    kind.flat_rms += flat_rms;
    kind.smooth_rms += smooth_rms;
    kind.flat_volume += std::abs(dirt::volume(flat) / volume - 1.0);
    kind.smooth_volume += std::abs(dirt::volume(smooth) / volume - 1.0);
    kind.all += 1;
    if (report->smooth_holes == 0) continue;
    kind.smooth += 1;
    EXPECT_LT(smooth_rms, (run % 3 == 0 ? 0.9 : 1.5) * flat_rms);
    EXPECT_LT(farthest(smooth, s.mesh), 0.2 * radius);
  }
  for (const sums& kind : of_kind) {
    std::printf("  smooth %zu of %zu, rms %.3f, volume %.3f of the flat patch's\n", kind.smooth, kind.all,
                kind.smooth_rms / kind.flat_rms, kind.smooth_volume / kind.flat_volume);
    EXPECT_LT(kind.smooth_rms, 0.3 * kind.flat_rms);
    EXPECT_LT(kind.smooth_volume, 0.3 * kind.flat_volume);
    EXPECT_GT(10 * kind.smooth, 7 * kind.all);
  }
}

/// Upright wall of `rows` rows around a polygon, narrower upwards by the taper, a little rough, without a lid; with a floor
/// where it is asked for.
triangle_mesh open_wall(std::uint32_t sides, std::uint32_t rows, double taper, double roughness, bool floor,
                        shapes::dice& dice) {
  triangle_mesh out;
  const double height = 0.1;
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double up = static_cast<double>(i) / rows;
      const double r = 0.02 * (1.0 - taper * up) * (1.0 + roughness * dice(-1.0, 1.0));
      const double a = 2.0 * std::numbers::pi * j / sides;
      out.positions.emplace_back(r * std::cos(a), r * std::sin(a), height * up);
    }
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t a = i * sides + j, b = i * sides + (j + 1) % sides;
      out.triangles.push_back({a, b, b + sides});
      out.triangles.push_back({a, b + sides, a + sides});
    }
  if (floor) {
    const auto middle = static_cast<std::uint32_t>(out.positions.size());
    out.positions.emplace_back(0.0, 0.0, 0.0);
    for (std::uint32_t j = 0; j < sides; ++j) out.triangles.push_back({middle, (j + 1) % sides, j});
  }
  return out;
}

TEST(SmoothFill, EndsOfTubesAndFlatCutsStayAsTheyWere) {
  const auto runs = test_support::extent<std::size_t>(60, 1000);
  shapes::dice dice(test_support::fresh_seed("smooth fill, tubes", "60 or 1,000 tubes"));
  for (std::size_t run = 0; run < runs; ++run) {
    triangle_mesh open;
    const auto sides = static_cast<std::uint32_t>(8 + dice.below(60));
    if (run % 3 == 0) {  // a box that lacks a part of one face, up to an edge
      const int n = 6 + static_cast<int>(dice.below(10));
      open = shapes::box({0.1, 0.08, 0.06}, {n, n, n});
      const double from = dice(-0.05, 0.03);
      std::erase_if(open.triangles, [&](const auto& t) {
        const vec3 p = (open.positions[t[0]] + open.positions[t[1]] + open.positions[t[2]]) / 3.0;
        return p.z > 0.0299 && p.x > from;
      });
    } else {
      open = open_wall(sides, static_cast<std::uint32_t>(10 + dice.below(20)), dice(0.0, 0.7),
                       run % 3 == 1 ? 0.0 : dice(0.0, 0.02), dice() < 0.5, dice);
    }
    SCOPED_TRACE("run " + std::to_string(run));
    triangle_mesh flat = open;
    repair_settings as_before = flat_only(), now;
    as_before.largest_made_up_share = now.largest_made_up_share = 0.5;
    ASSERT_TRUE(repair(flat, as_before));
    const auto report = repair(open, now);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->smooth_holes, 0U);
    EXPECT_TRUE(open.positions == flat.positions);
    EXPECT_TRUE(open.triangles == flat.triangles);
  }
}

/// A ball without its cap above the height, in radii.
triangle_mesh ball_without_cap(double height) {
  triangle_mesh out = dirt::ball(40, 60);
  std::erase_if(out.triangles, [&](const auto& t) {
    return (out.positions[t[0]].z + out.positions[t[1]].z + out.positions[t[2]].z) / 3.0 > 0.05 * height;
  });
  return out;
}

TEST(SmoothFill, StaysFlatWhereItWouldCrossAnotherSurface) {
  shapes::dice dice(test_support::fresh_seed("smooth fill, crossing", "12 balls"));
  for (int run = 0; run < 12; ++run) {
    const double height = dice(0.6, 0.8);
    triangle_mesh alone = ball_without_cap(height);
    const auto free = repair(alone);
    ASSERT_TRUE(free) << free.error().message;
    EXPECT_EQ(free->smooth_holes, 1U);
    // A little ball in the way of the new cap, clear of the flat patch.
    const vec3 in_the_way(0.003 * dice(-1.0, 1.0), 0.003 * dice(-1.0, 1.0), 0.05);
    triangle_mesh beside = shapes::both(ball_without_cap(height), shapes::scaled(dirt::ball(8, 12), 0.08, in_the_way));
    const auto report = repair(beside);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ((*report)[repair_kind::hole].count, 1U);
    EXPECT_EQ(report->smooth_holes, 0U);
  }
}

TEST(SmoothFill, MakesUpNoMoreThanTheLimit) {
  shapes::dice dice(test_support::fresh_seed("smooth fill, limit", "12 balls"));
  for (int run = 0; run < 12; ++run) {
    const triangle_mesh open = ball_without_cap(dice(0.5, 0.7));
    triangle_mesh flat = open, smooth = open;
    const auto less = repair(flat, flat_only());
    repair_settings generous;
    generous.largest_made_up_share = 0.5;
    const auto more = repair(smooth, generous);
    ASSERT_TRUE(less && more);
    ASSERT_EQ(more->smooth_holes, 1U);
    ASSERT_GT(more->made_up_share, less->made_up_share);
    repair_settings between;
    between.largest_made_up_share = dice(less->made_up_share, more->made_up_share);
    triangle_mesh limited = open;
    const auto report = repair(limited, between);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->smooth_holes, 0U);
    EXPECT_TRUE(limited.triangles == flat.triangles);
  }
}

}  // namespace
}  // namespace asperity::bake
