// The exact maximum against what can be known without it: merged grids of aligned textures, dense samples, itself.
#include "exact/exact_depth.hpp"

#include <cstdio>
#include <gtest/gtest.h>
#include <limits>

#include "bumpy_plates.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr std::array modes{parallax_mode::paper_lookup, parallax_mode::exact};

// Two bilinear textures with their rows along the same axes: on the grid that both grids' lines make, their difference
// is bilinear from node to node, so its largest value is at a node.
TEST(ExactDepth, IsTheLargestNodeOfTheMergedGridOfAlignedTextures) {
  const plate_spec a = bumps(0.002, 120, 1e-4, 4000.0, false), b = bumps(0.003, 100, 8e-5, 5200.0, false);
  const scene s{make_plate(a), {make_plate(b)}};
  const double half_window = 1.3e-3;
  for (const vec2& shift : {vec2(0.0), vec2(1.23e-4, -3.1e-5), vec2(-2.2e-4, 1.7e-4)}) {
    const vec3 position(shift.x, shift.y, -1e-4);
    // Plate A is turned half about x: its (x, y) lies over (x, -y) of the window's plane.
    const auto texel = [](const model_ptr& m, const plate_spec& p, double x, double y) {
      const double per_image_x = p.texels / (2.0 * p.half_x * m->texture.width);
      const double per_image_y = p.texels / (2.0 * p.half_y * m->texture.height);
      return m->texture.sample({(plate_gutter + 0.5 * p.texels) / m->texture.width + x * per_image_x,
                                (plate_gutter + 0.5 * p.texels) / m->texture.height + y * per_image_y});
    };
    const auto depth = [&](double x, double y) {  // world x, y; heights along -z
      const double h_a = texel(s.probe, a, x - shift.x, -(y - shift.y)).z;
      const double h_b = texel(s.fixed[0], b, x, y).z;
      return h_a - position.z + h_b;
    };
    const auto lines = [&](double shift_a) {
      std::vector<double> at{-half_window, half_window};
      for (const auto& [p, from] : {std::pair{&a, shift_a}, {&b, 0.0}}) {
        const double pitch = 2.0 * p->half_x / p->texels;
        for (std::uint32_t i = 0; i < p->texels; ++i) {
          const double x = from - p->half_x + (i + 0.5) * pitch;
          if (std::fabs(x) < half_window) at.push_back(x);
        }
      }
      return at;
    };
    double expected = -1.0;
    for (const double x : lines(shift.x)) {
      for (const double y : lines(shift.y)) expected = std::max(expected, depth(x, y));
    }
    for (const parallax_mode mode : modes) {
      exact_depth backend(s, {.parallax = mode, .epsilon_m = 1e-11});
      const penetration p = measure_whole(backend, s, window_downwards(half_window), {face_down(), position});
      EXPECT_NEAR(p.depth_m, expected, 2e-9) << "positions in a texture are float32";
      EXPECT_LE(backend.brackets()[0].upper_m - p.depth_m, 1e-11);
      cpu_depth grid = grid_backend(s, mode, 64);
      EXPECT_GT(expected - measure_whole(grid, s, window_downwards(half_window), {face_down(), position}).depth_m, 2e-8)
          << "a grid would do as well: the test shows nothing";
    }
  }
}

TEST(ExactDepth, NoGridIsDeeperAndFinerGridsComeNearer) {
  constexpr std::array<std::uint32_t, 4> grids{30, 60, 120, 480};
  dice d(31);
  std::array<double, grids.size()> missing{};
  for (const bool charts : {false, true}) {
    const scene s = bumpy_scene(charts);
    for (const parallax_mode mode : modes) {
      exact_depth exact(s, {.parallax = mode});
      for (int i = 0; i < 2; ++i) {
        const pose T = some_pose(d);
        const penetration p = measure(exact, place(s, window_downwards(2.43e-3), T));
        const depth_bracket bracket = exact.brackets()[0];
        EXPECT_FALSE(bracket.capped);
        EXPECT_LE(bracket.upper_m - bracket.lower_m, exact.settings().epsilon_m);
        EXPECT_EQ(bracket.lower_m, p.depth_m);
        for (std::size_t g = 0; g < grids.size(); ++g) {
          cpu_depth sampled = grid_backend(s, mode, grids[g]);
          const double depth_m = measure(sampled, place(s, window_downwards(2.43e-3), T)).depth_m;
          EXPECT_LE(depth_m, bracket.upper_m) << "grid of " << grids[g];
          missing[g] += (p.depth_m - depth_m) / 8.0;
        }
      }
    }
  }
  std::printf("  mean depth that a grid misses, um:");
  for (std::size_t g = 0; g < grids.size(); ++g) std::printf("  N = %u: %.3f", grids[g], missing[g] * 1e6);
  std::printf("\n");
  for (std::size_t g = 1; g < grids.size(); ++g) EXPECT_LT(missing[g], 0.6 * missing[g - 1]);
}

// A dense grid about the witness, in a window a hundred times smaller: samples 0.5 um apart find the maximum from
// below.
TEST(ExactDepth, DenseSamplesAboutTheWitnessReachTheBracketFromBelow) {
  dice d(32);
  int judged = 0;
  for (const bool charts : {false, true}) {
    const scene s = bumpy_scene(charts);
    for (const parallax_mode mode : modes) {
      exact_depth exact(s, {.parallax = mode});
      cpu_depth sampled = grid_backend(s, mode, 101);
      for (int i = 0; i < 3; ++i) {
        const pose T = some_pose(d);
        const contact_window window = window_downwards(2.5e-3);
        const penetration p = measure(exact, place(s, window, T));
        if (has(p.flags, depth_flag::window_too_small)) continue;  // samples beyond the window's border may be deeper
        ++judged;
        contact_window close = window;
        close.half_size_m = 2.5e-5;
        close.centre_w = p.witness_w;
        // With the paper's lookup the witness lies beside its line, by what its fine point is beside the coarse one.
        if (mode == parallax_mode::paper_lookup) close.half_size_m = 1.5e-4;
        const double dense_m = measure(sampled, place(s, close, T)).depth_m;
        EXPECT_LE(dense_m, exact.brackets()[0].upper_m);
        EXPECT_GE(dense_m, p.depth_m - (mode == parallax_mode::exact ? 2e-8 : 1e-7));
      }
    }
  }
  EXPECT_GE(judged, 6);
}

TEST(ExactDepth, ASmallerEpsilonNarrowsTheBracketAndEveryBracketHolds) {
  const scene s = bumpy_scene(true);
  dice d(33);
  for (int i = 0; i < 2; ++i) {
    const placed p = place(s, window_downwards(2.5e-3), some_pose(d));
    exact_depth sharp(s, {.epsilon_m = 1e-11});
    static_cast<void>(measure(sharp, p));
    const depth_bracket truth = sharp.brackets()[0];
    ASSERT_FALSE(truth.capped);
    std::size_t nodes = 0;
    for (const double epsilon : {1e-5, 1e-7, 1e-9}) {
      exact_depth backend(s, {.epsilon_m = epsilon});
      static_cast<void>(measure(backend, p));
      const depth_bracket b = backend.brackets()[0];
      EXPECT_LE(b.upper_m - b.lower_m, epsilon);
      EXPECT_LE(b.lower_m, truth.upper_m);
      EXPECT_GE(b.upper_m, truth.lower_m);
      EXPECT_GE(b.nodes, nodes) << "less work for more";
      nodes = b.nodes;
    }
  }
}

TEST(ExactDepth, ANodeCapIsToldAndTheBracketStillHolds) {
  const scene s = bumpy_scene(true);
  const placed p = place(s, window_downwards(2.5e-3), {face_down(), {1e-4, 2e-4, -1e-4}});
  exact_depth whole(s);
  EXPECT_FALSE(has(measure(whole, p).flags, depth_flag::unresolved));
  const depth_bracket truth = whole.brackets()[0];
  ASSERT_GT(truth.nodes, 100U);
  double width = std::numeric_limits<double>::infinity();
  for (const std::uint32_t cap : {1U, 10U, 100U}) {
    exact_depth capped(s, {.max_nodes = cap});
    EXPECT_TRUE(has(measure(capped, p).flags, depth_flag::unresolved));
    const depth_bracket b = capped.brackets()[0];
    EXPECT_TRUE(b.capped);
    EXPECT_LE(b.nodes, cap);
    EXPECT_LE(b.lower_m, truth.upper_m);
    EXPECT_GE(b.upper_m, truth.lower_m);
    EXPECT_LE(b.upper_m - b.lower_m, width);
    width = b.upper_m - b.lower_m;
  }
  EXPECT_GT(width, whole.settings().epsilon_m);
}

TEST(ExactDepth, TheSameInputsGiveTheSameBits) {
  const scene s = bumpy_scene(true);
  dice d(34);
  const placed p = place(s, window_downwards(2.5e-3), some_pose(d)), q = place(s, window_downwards(2e-3), some_pose(d));
  exact_depth first(s), second(s);
  const penetration once = measure(first, p);
  const depth_bracket bracket = first.brackets()[0];
  static_cast<void>(measure(first, q));  // nothing of another contact is left behind
  for (exact_depth* backend : {&first, &second}) {
    const penetration again = measure(*backend, p);
    EXPECT_EQ(again.depth_m, once.depth_m);
    EXPECT_EQ(again.witness_w, once.witness_w);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(again.gradient[i], once.gradient[i]);
    EXPECT_EQ(backend->brackets()[0].upper_m, bracket.upper_m);
    EXPECT_EQ(backend->brackets()[0].nodes, bracket.nodes);
  }
}

// The derivative of the maximum is that of the depth along its line. At a texel border the slope of a bilinear surface
// jumps by curvature times texel: that is what one side's slope may be off by.
TEST(ExactDepth, TheGradientIsThatOfTheMaximum) {
  plate_spec a = bumps(0.001, 512, 5e-5, 3000.0, false), b = bumps(0.0015, 700, 4e-5, 3700.0, false);
  const scene s{make_plate(a), {make_plate(b)}};
  const double slope_jump = 2.0 * 9e-5 * 3700.0 * 3700.0 * 4.3e-6;
  dice d(35);
  int judged = 0;
  for (const parallax_mode mode : modes) {
    exact_depth backend(s, {.parallax = mode, .epsilon_m = 1e-12});
    const contact_window window = window_downwards(8e-4);
    for (int i = 0; i < 2; ++i) {
      pose T = some_pose(d);
      T.position *= 0.1;
      const penetration p = measure_whole(backend, s, window, T);
      if (has(p.flags, depth_flag::window_too_small)) continue;
      ++judged;
      EXPECT_NEAR(glm::dot(p.gradient.linear, window.n_ab_w), 1.0, 1e-12);
      EXPECT_EQ(largest_entry({.curvature = p.curvature}), 0.0);
      const vec3 centre = centre_of_mass_w(s, T);
      for (std::size_t k = 0; k < 6; ++k) {
        const double step = k < 3 ? 1e-6 : 1e-4;
        vec6 q{};
        (k < 3 ? q.linear : q.angular)[static_cast<int>(k % 3)] = step;
        const double plus = measure_whole(backend, s, window, moved(T, centre, q)).depth_m;
        const double minus = measure_whole(backend, s, window, moved(T, centre, -1.0 * q)).depth_m;
        EXPECT_NEAR((plus - minus) / (2.0 * step), p.gradient[k], slope_jump * (k < 3 ? 1.0 : 0.015)) << k;
      }
    }
  }
  EXPECT_GE(judged, 2);
}

TEST(ExactDepth, AHoleIsLeftOutAndTold) {
  const plate_spec a = bumps(0.002, 120, 1e-4, 4000.0, false), b = bumps(0.003, 100, 8e-5, 5200.0, false);
  const scene whole{make_plate(a), {make_plate(b)}};
  const contact_window window = window_downwards(1.3e-3);
  const pose T{exp_rotation(vec3(0.01, 0.02, 0.4)) * face_down(), {0.0, 0.0, -1e-4}};
  exact_depth intact(whole);
  const penetration before = measure_whole(intact, whole, window, T);
  // Take out the texels about the witness.
  textured_model torn = *whole.probe;
  const vec3 witness_a = inverse(T) * before.witness_w;
  for (glm::vec3& texel : torn.texture.texels) {
    if (glm::distance(vec3(texel), witness_a) < 5e-5) texel = glm::vec3(std::numeric_limits<float>::quiet_NaN());
  }
  const scene holed{std::make_shared<const textured_model>(std::move(torn)), whole.fixed};
  exact_depth backend(holed);
  const penetration p = measure_whole(backend, holed, window, T);
  EXPECT_TRUE(has(p.flags, depth_flag::bad_texel));
  EXPECT_LT(p.depth_m, before.depth_m);
  cpu_depth grid = grid_backend(holed, parallax_mode::exact, 200);
  const double sampled = measure_whole(grid, holed, window, T).depth_m;
  EXPECT_LE(sampled, backend.brackets()[0].upper_m);
  EXPECT_NEAR(sampled, p.depth_m, 2e-6);
}

TEST(ExactDepth, SettingsOutOfRangeAreRefusedByName) {
  const scene s = bumpy_scene(false);
  const auto refused = [&](const exact_depth_settings& settings, const std::string& name) {
    const auto made = make_exact_depth(s, settings);
    ASSERT_FALSE(made.has_value());
    EXPECT_NE(made.error().message.find(name), std::string::npos) << made.error().message;
  };
  refused({.epsilon_m = 0.0}, "epsilon_m");
  refused({.epsilon_m = std::numeric_limits<double>::quiet_NaN()}, "epsilon_m");
  refused({.max_nodes = 0}, "max_nodes");
  refused({.max_nodes = 1U << 31}, "max_nodes");
  refused({.grid = 1}, "grid");
  refused({.facing_cosine = 0.0}, "facing_cosine");
  ASSERT_TRUE(make_exact_depth(s).has_value());
  EXPECT_FALSE(make_exact_depth(scene{}).has_value());
  exact_depth unready(s, {.epsilon_m = -1.0});
  penetration out;
  const pose T_wb;
  EXPECT_EQ(unready.measure({{}, std::span(&T_wb, 1)}, contact_set{}, std::span(&out, 1)), status::not_ready);
}

}  // namespace
}  // namespace asperity
