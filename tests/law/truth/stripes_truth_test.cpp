// A texture is felt as high as it is, however coarse the mesh that carries it and however deep the press.
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <random>

#include "law/truth/reported.hpp"
#include "law/truth/striped_ball.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::truth {
namespace {

/// How far what was told at the stripes' wavelength is from what is exact, as a share of the latter.
struct ripple_errors {
  double depth = 0.0, direction = 0.0;  ///< of the deepest plane
  double force = 0.0;                   ///< of the lateral force for poses alone
  double mean_force = 0.0;              ///< the force itself, at the worst pose, as a share of itself
};

ripple_errors slide_over(const striped_ball& ball, const ball_slide& slide, const truth_pair& both,
                         const quat& turned) {
  plane_law planes(both.bodies, both.fields);
  pose_law force(both.bodies, both.fields);
  const double k = force.stiffness_n_per_m();
  std::vector<double> depth, aside, lateral, exact_depth, exact_aside, exact_lateral;
  double worst_mean = 0.0;
  for (std::size_t i = 0; i < ball_slide::steps; ++i) {
    const pose at = slide.at(ball, i);
    const pose T_wa{turned, at.position};
    const vec3 north = slide.north_w(ball, i);
    const auto p = planes.deepest(T_wa);
    const reported_force f = force.at(T_wa);
    const double latitude = slide.latitude(ball, i);
    const double d = exact_depth_m(ball, slide, latitude, depth_along::radius);
    const double slope = exact_slope(ball, slide, latitude, depth_along::radius);
    const double near_slope = exact_slope(ball, slide, latitude, depth_along::nearest);
    depth.push_back(p ? p->depth_m : 0.0);
    aside.push_back(p ? glm::dot(p->n_ab_w, north) : 0.0);
    lateral.push_back(glm::dot(f.on_probe_w.force, north));
    exact_depth.push_back(exact_depth_m(ball, slide, latitude, depth_along::nearest));
    exact_aside.push_back(near_slope / std::hypot(1.0, near_slope));
    exact_lateral.push_back(-k * d * slope);
    worst_mean =
        std::max(worst_mean, std::fabs(glm::length(f.on_probe_w.force) / (k * d * std::hypot(1.0, slope)) - 1.0));
  }
  const auto off = [](const std::vector<double>& reported, const std::vector<double>& exact) {
    const auto is = at_the_wavelength(reported), should = at_the_wavelength(exact);
    return std::abs(is - should) / std::abs(should);
  };
  return {off(depth, exact_depth), off(aside, exact_aside), off(lateral, exact_lateral), worst_mean};
}

/// The small ball and the striped one. @param shifted the striped ball's texture is moved aside by a texel
truth_pair balls(std::size_t triangles, bool shifted = false) {
  static const model_ptr small = formula_ball(1e-3);
  static const field_body_ptr small_field = built_field_body(*small, {.sample_pitch_m = 25e-6});
  model_ptr large = baked_ball({}, triangles);
  if (shifted) large = std::make_shared<const textured_model>(with_shifted_relief(*large));
  return {{small, {large}}, std::make_shared<const field_scene>(field_scene{small_field, {built_field_body(*large)}})};
}

struct drawn_slide {
  ball_slide slide;
  quat turned;
};
drawn_slide draw(std::mt19937_64& bits) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  drawn_slide out;
  out.slide.meridian_rad = std::numbers::pi * unit(bits);
  out.slide.from_rad = 0.6 * unit(bits);
  out.turned = glm::normalize(quat(unit(bits), unit(bits), unit(bits), unit(bits)));
  return out;
}

constexpr double wished = 0.05;
// At 1.5 mm, 3.6 pitches deep, the smooth part of the field comes from distances to the nearest of a few triangles,
// which are wrong by up to 3 um there. The least motion is read where it ends, at the surface, and does not mind.
constexpr double of_deep_planes = 0.3, of_deep_directions = 0.3;
constexpr double of_planes = 0.12;      // at most 0.5 mm deep: 0.075 measured, of which the median has 0.02
constexpr double of_directions = 0.15;  // of planes, where the deepest sample changes: 0.081 measured

constexpr std::array<std::size_t, 3> bakes{150, 600, 2000};

/// Triangles of the bake that an ordinary run feels, another one each day; planted faults are of 600 at length.
std::size_t bake_of_this_run(std::uint64_t seed) {
  return test_support::at_length() ? 600 : bakes[seed % bakes.size()];
}

TEST(stripes_truth, are_felt_as_they_are_on_any_bake_and_at_any_depth) {
  const int slides = test_support::extent(1, 8);
  const std::uint64_t seed =
      test_support::fresh_seed("stripes", "1 bake, 3 depths, 1 slide (3 bakes, 8 slides at length)");
  for (std::size_t i = 0; i < bakes.size(); ++i) {
    if (!test_support::at_length() && bakes[i] != bake_of_this_run(seed)) continue;
    const std::size_t triangles = bakes[i];
    const truth_pair both = balls(triangles);
    std::mt19937_64 bits(test_support::seed_of(seed, "stripes", triangles));
    for (int n = 0; n < slides; ++n) {
      drawn_slide on = draw(bits);
      for (const double pressed_m : {0.1e-3, 0.5e-3, 1.5e-3}) {
        on.slide.pressed_m = pressed_m;
        const ripple_errors e = slide_over({}, on.slide, both, on.turned);
        std::printf(
            "  %4zu triangles, %.1f mm: planes' depth off by %.1f %%, direction %.1f %%; lateral force %.1f %%, force "
            "%.1f %%\n",
            triangles, 1e3 * pressed_m, 100.0 * e.depth, 100.0 * e.direction, 100.0 * e.force, 100.0 * e.mean_force);
        const bool deep = pressed_m > 1e-3;
        EXPECT_LE(e.force, wished);
        EXPECT_LE(e.mean_force, wished);
        EXPECT_LE(e.depth, deep ? of_deep_planes : of_planes);
        EXPECT_LE(e.direction, deep ? of_deep_directions : of_directions);
      }
    }
  }
}

// A texel is a twentieth of a wave, a phase of 0.3 rad.
TEST(stripes_truth, notice_a_texture_that_is_moved_aside_by_a_texel) {
  const std::uint64_t seed = test_support::fresh_seed("shifted stripes", "2 slides");
  const truth_pair both = balls(bake_of_this_run(seed), true);
  std::mt19937_64 bits(test_support::seed_of(seed, "shifted stripes"));
  double force = 0.0, depth = 0.0;
  for (int n = 0; n < 2; ++n) {
    drawn_slide on = draw(bits);
    on.slide.pressed_m = 0.5e-3;
    const ripple_errors e = slide_over({}, on.slide, both, on.turned);
    force = std::max(force, e.force);
    depth = std::max(depth, e.depth);
  }
  std::printf("  moved aside: planes' depth off by %.1f %%, lateral force by %.1f %%\n", 100.0 * depth, 100.0 * force);
  EXPECT_GT(force, wished);
  EXPECT_GT(depth, wished);
}

// Stripes of 18 um are not stripes of 20 um.
TEST(stripes_truth, notice_stripes_that_are_a_tenth_too_low) {
  const std::uint64_t seed = test_support::fresh_seed("low stripes", "1 slide");
  std::mt19937_64 bits(test_support::seed_of(seed, "low stripes"));
  drawn_slide on = draw(bits);
  on.slide.pressed_m = 0.5e-3;
  striped_ball higher;
  higher.height_m *= 10.0 / 9.0;
  const ripple_errors e = slide_over(higher, on.slide, balls(bake_of_this_run(seed)), on.turned);
  EXPECT_GT(e.force, wished);
  EXPECT_GT(e.depth, wished);
}

}  // namespace
}  // namespace asperity::truth
