// What the backend reports beside the depth: flags, witness, area; and what it does with bad input.
#include "asperity/window/cpu_depth.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "session/rt/tick_trap.hpp"
#include "support/height_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr gradient_scheme schemes[] = {gradient_scheme::soft_max, gradient_scheme::central_difference};

height_function bump(double height, double width) {
  return [=](double x, double y) { return height * std::exp(-(x * x + y * y) / (2.0 * width * width)); };
}

plate_spec plate(double half, height_function f = {}, std::uint32_t texels = 256) {
  plate_spec s;
  s.half_x = s.half_y = half;
  s.texels = texels;
  s.height = std::move(f);
  return s;
}

TEST(CpuDepth, WitnessIsTheDeepestPointOfTheProbesFineSurface) {
  const scene s{make_plate(plate(0.01, bump(1e-3, 1e-3))), {make_plate(plate(0.01))}};
  for (const gradient_scheme g : schemes) {
    window_depth_settings settings;
    settings.gradient = g;
    cpu_depth backend(s, settings);
    const penetration p = measure_whole(backend, s, window_downwards(5e-3), {face_down(), {1e-3, -2e-3, 0.8e-3}});
    EXPECT_NEAR(p.depth_m, 2e-4, 1e-5);
    EXPECT_LT(glm::length(p.witness_w - vec3(1e-3, -2e-3, -2e-4)), 2e-4);
    EXPECT_EQ(p.flags, depth_flag::none);
    EXPECT_NEAR(p.area_m2, 1e-4, 1e-12);
    EXPECT_EQ(p.samples, 64U * 64U);
  }
}

TEST(CpuDepth, AGapIsANegativeDepth) {
  const scene s{make_plate(plate(0.01, bump(1e-3, 1e-3))), {make_plate(plate(0.01))}};
  cpu_depth backend(s);
  const penetration p = measure_whole(backend, s, window_downwards(5e-3), {face_down(), {0.0, 0.0, 1.5e-3}});
  EXPECT_NEAR(p.depth_m, -0.5e-3, 1e-5);
  EXPECT_NEAR(glm::dot(p.gradient.linear, vec3(0, 0, -1)), 1.0, 1e-12);
}

TEST(CpuDepth, SaysWhenTheWindowCutsTheContact) {
  const scene s{make_plate(plate(0.01, bump(1e-3, 1e-3))), {make_plate(plate(0.01))}};
  cpu_depth backend(s);
  const auto flags = [&](const contact_window& w) {
    return measure_whole(backend, s, w, {face_down(), {0.0, 0.0, 0.8e-3}}).flags;
  };
  EXPECT_TRUE(has(flags(window_downwards(2e-3, vec3(2.5e-3, 0.0, 0.0))), depth_flag::window_too_small));
  EXPECT_FALSE(has(flags(window_downwards(2e-3)), depth_flag::window_too_small));
  // Level faces are as deep at the border as anywhere: nothing is hidden beyond it.
  const scene level{make_plate(plate(0.01)), {make_plate(plate(0.02))}};
  cpu_depth flat(level);
  EXPECT_FALSE(has(measure_whole(flat, level, window_downwards(5e-3), {face_down(), {0, 0, -1e-4}}).flags,
                   depth_flag::window_too_small));
}

TEST(CpuDepth, LeavesNanTexelsOutAndSaysSo) {
  auto holed = std::make_shared<textured_model>(*make_plate(plate(0.01, bump(1e-3, 1e-3))));
  // The bump's peak is lost: a square of 40 texels, 3.1 mm, about the middle.
  for (std::uint32_t j = 108; j < 148; ++j) {
    for (std::uint32_t i = 108; i < 148; ++i) {
      holed->texture.texels[j * holed->texture.width + i] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    }
  }
  const scene s{holed, {make_plate(plate(0.01))}};
  for (const gradient_scheme g : schemes) {
    for (const parallax_mode mode : {parallax_mode::exact, parallax_mode::paper_lookup}) {
      window_depth_settings settings;
      settings.gradient = g;
      settings.parallax = mode;
      cpu_depth backend(s, settings);
      const penetration p = measure_whole(backend, s, window_downwards(5e-3), {face_down(), {0.0, 0.0, 0.0}});
      EXPECT_TRUE(has(p.flags, depth_flag::bad_texel));
      EXPECT_GT(p.depth_m, 0.0);
      EXPECT_LT(p.depth_m, 0.5e-3);
      EXPECT_LT(p.samples, 64U * 64U);
      EXPECT_TRUE(is_finite(p.gradient));
    }
  }
}

TEST(CpuDepth, ReportsNothingWithoutACommonSample) {
  const scene s{make_plate(plate(0.004)), {make_plate(plate(0.004))}};
  for (const gradient_scheme g : schemes) {
    window_depth_settings settings;
    settings.gradient = g;
    cpu_depth backend(s, settings);
    for (const penetration& p : {measure_whole(backend, s, window_downwards(5e-3), {face_down(), {0.009, 0.0, -1e-4}}),
                                 measure_whole(backend, s, window_downwards(0.0), {face_down(), {0.0, 0.0, -1e-4}})}) {
      EXPECT_EQ(p.flags, depth_flag::no_overlap);
      EXPECT_EQ(p.depth_m, 0.0);
      EXPECT_EQ(p.soft_depth_m, 0.0);
      EXPECT_EQ(p.samples, 0U);
      EXPECT_EQ(largest_entry(p), 0.0);
    }
  }
}

TEST(CpuDepth, RefusesWhatDoesNotFit) {
  const scene s{make_plate(plate(0.004)), {make_plate(plate(0.004))}};
  const contact_set contacts = whole_contact(s, window_downwards(3e-3));
  const pose T_wb;
  penetration out;
  cpu_depth backend(s);
  const scene_pose at{{face_down(), vec3(0.0)}, std::span(&T_wb, 1)};
  EXPECT_EQ(backend.measure(at, contacts, std::span(&out, 1)), status::ok);
  EXPECT_EQ(backend.measure(at, contacts, std::span<penetration>()), status::not_ready);
  EXPECT_EQ(backend.measure({at.T_wa, {}}, contacts, std::span(&out, 1)), status::not_ready);
  EXPECT_EQ(out.flags, depth_flag::no_overlap);
  EXPECT_EQ(cpu_depth(s, {.grid = 0}).measure(at, contacts, std::span(&out, 1)), status::not_ready);
  EXPECT_EQ(cpu_depth({nullptr, {}}).measure(at, contacts, std::span(&out, 1)), status::not_ready);
  contact_set elsewhere;
  contact c;
  c.body = 7;
  ASSERT_TRUE(elsewhere.add(c, {}, {}));
  EXPECT_EQ(backend.measure(at, elsewhere, std::span(&out, 1)), status::not_ready);
}

TEST(CpuDepth, ANanPoseLeavesZerosBehind) {
  const scene s{make_plate(plate(0.004)), {make_plate(plate(0.004))}};
  for (const gradient_scheme g : schemes) {
    window_depth_settings settings;
    settings.gradient = g;
    cpu_depth backend(s, settings);
    const pose bad{face_down(), vec3(std::numeric_limits<double>::quiet_NaN())};
    const penetration p = measure_whole(backend, s, window_downwards(3e-3), bad);
    EXPECT_TRUE(has(p.flags, depth_flag::no_overlap));
    EXPECT_EQ(p.depth_m, 0.0);
    EXPECT_EQ(largest_entry(p), 0.0);
  }
}

TEST(CpuDepth, DoesNothingThatATickMustNotDo) {
  const scene s{make_plate(plate(0.01, bump(1e-3, 1e-3))), {make_plate(plate(0.01))}};
  for (const gradient_scheme g : schemes) {
    window_depth_settings settings;
    settings.gradient = g;
    cpu_depth backend(s, settings);
    const contact_set contacts = whole_contact(s, window_downwards(5e-3));
    const pose T_wb;
    penetration out;
    tick_trap trap;
    for (int i = 0; i < 5; ++i) {
      const pose T_wa{face_down(), {1e-4 * i, 0.0, 0.5e-3}};
      status answer = status::ok;
      trap([&] { answer = backend.measure({T_wa, std::span(&T_wb, 1)}, contacts, std::span(&out, 1)); });
      ASSERT_EQ(answer, status::ok);
    }
  }
}

TEST(CpuDepth, RefiningFindsTheMaximumBetweenSamples) {
  const scene s{make_plate(plate(0.01, bump(1e-3, 2e-3), 2048)), {make_plate(plate(0.01))}};
  window_depth_settings settings;
  settings.grid = 50;  // no sample on the peak
  cpu_depth sampled(s, settings);
  settings.refine_maximum = true;
  cpu_depth refined(s, settings);
  const pose T{face_down(), {3.1e-5, 4.7e-5, 0.8e-3}};
  const double error_sampled = std::fabs(measure_whole(sampled, s, window_downwards(5e-3), T).depth_m - 2e-4);
  const double error_refined = std::fabs(measure_whole(refined, s, window_downwards(5e-3), T).depth_m - 2e-4);
  EXPECT_GT(error_sampled, 5e-7);
  EXPECT_LT(error_refined, 0.1 * error_sampled);
}

}  // namespace
}  // namespace asperity
