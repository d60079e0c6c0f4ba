// Where occlusion_depth ends: depths out of range, flags, too many contacts, a lost context, settings that it refuses.
#include <limits>
#include <memory>

#include "hardware/gl/occlusion_fixture.hpp"

namespace asperity::gl {
namespace {

TEST_F(GlOcclusionDepth, BeyondTheRangeIsNeitherNoOverlapNorTheOtherEnd) {
  const scene s = flat_scene();
  const contact_window w = test_support::window_downwards(4e-3);
  occlusion_depth backend = make(s, {.depth_range_m = 1e-3});
  const auto at = [&](double x, double depth) {
    return test_support::measure_whole(backend, s, w, {test_support::face_down(), {x, 0.0, -depth}});
  };
  const penetration within = at(0.0, 5e-5);
  EXPECT_NEAR(backend.quantum_m(0), 2e-3 / 65532, 1e-15);
  const penetration deep = at(0.0, 3e-3), far = at(0.0, -3e-3), beside = at(0.05, 5e-5);
  EXPECT_EQ(backend.quantum_m(0), 0.0);
  EXPECT_EQ(within.flags, depth_flag::none);
  EXPECT_NEAR(within.depth_m, 5e-5, 2e-3 / 65532);
  EXPECT_EQ(deep.flags, depth_flag::saturated);
  EXPECT_NEAR(deep.depth_m, 1e-3, 1e-12);
  EXPECT_EQ(far.flags, depth_flag::saturated);
  EXPECT_NEAR(far.depth_m, -1e-3, 1e-12);
  EXPECT_GT(far.samples, 0U);
  expect_nothing(beside);
  EXPECT_EQ(backend.counters().round_trips, 3U * 17) << "a patch outside of its window is not drawn";
  // Both patches in the window, one at either side.
  expect_nothing(test_support::measure_whole(backend, s, test_support::window_downwards(4e-3, {0.012, 0.0, 0.0}),
                                             {test_support::face_down(), {0.0185, 0.0, -5e-5}}));
  EXPECT_EQ(backend.counters().round_trips, 3U * 17 + 1) << "one round says that nothing overlaps";
}

TEST_F(GlOcclusionDepth, FlagsAreThoseOfTheCpuBackend) {
  const scene s = flat_scene();
  const contact_window w = test_support::window_downwards(4e-3);
  occlusion_depth backend = make(s), packed_backend = make(s, {.packed = true});
  cpu_depth reference(s, paper_depth_settings(32));
  // Tilted, it is deepest at one side of the window: each in turn.
  for (const vec3& tilt :
       {vec3(0.0), vec3(0.02, 0.0, 0.0), vec3(-0.02, 0.0, 0.0), vec3(0.0, 0.02, 0.0), vec3(0.0, -0.02, 0.0)}) {
    const pose T{exp_rotation(tilt) * test_support::face_down(), {0.0, 0.0, -1e-4}};
    for (occlusion_depth* b : {&backend, &packed_backend}) {
      const penetration p = test_support::measure_whole(*b, s, w, T);
      EXPECT_EQ(p.flags, test_support::measure_whole(reference, s, w, T).flags);
      EXPECT_EQ(has(p.flags, depth_flag::window_too_small), glm::length(tilt) > 0.0);
    }
  }

  auto broken = std::make_shared<textured_model>(*s.fixed[0]);
  for (std::size_t i = 30; i < 36; ++i) {
    for (std::size_t j = 30; j < 36; ++j) {
      broken->texture.texels[j * broken->texture.width + i].y = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const scene with_hole{s.probe, {broken}};
  for (const bool packed : {false, true}) {
    occlusion_depth holed = make(with_hole, {.packed = packed});
    cpu_depth holed_reference(with_hole, paper_depth_settings(32));
    const pose T{test_support::face_down(), {0.0, 0.0, -1e-4}};
    const penetration p = test_support::measure_whole(holed, with_hole, w, T);
    const penetration q = test_support::measure_whole(holed_reference, with_hole, w, T);
    EXPECT_EQ(p.flags, depth_flag::bad_texel);
    EXPECT_EQ(p.flags, q.flags);
    EXPECT_EQ(p.samples, q.samples);
    EXPECT_LT(p.samples, 1024U);
  }
}

TEST_F(GlOcclusionDepth, WhatDoesNotFitIsAStatusAndLeavesZeros) {
  const windows w(3);
  std::vector<penetration> out(3, penetration{.depth_m = 1.0});
  occlusion_depth two = make(w.bodies(), {.contacts = 2});
  EXPECT_EQ(two.measure(w.at(), w.contacts, out), status::capacity_reached);
  for (const penetration& p : out) expect_nothing(p);
  EXPECT_EQ(two.quantum_m(0), 0.0);
  EXPECT_EQ(two.counters().round_trips, 0U);
  occlusion_depth tight = make(w.bodies(), {.triangles = 2});
  EXPECT_EQ(tight.measure(w.at(), w.contacts, out), status::capacity_reached);
  for (const penetration& p : out) expect_nothing(p);
}

TEST_F(GlOcclusionDepth, ALostContextIsAStatusAndLeavesZeros) {
  const windows w(2);
  auto other = open_context();
  ASSERT_TRUE(other);
  auto made = occlusion_depth::make(*other, w.bodies(), paper_depth_settings(16));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(context->make_current(), status::ok);
  static_cast<void>(w.measure(*made));
  (*other)->simulate_loss();
  std::vector<penetration> out(2, penetration{.depth_m = 1.0});
  EXPECT_EQ(made->measure(w.at(), w.contacts, out), status::backend_failed);
  for (const penetration& p : out) expect_nothing(p);
  EXPECT_FALSE(made->read_tiles());
  const auto again = occlusion_depth::make(*other, w.bodies());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, error_code::unsupported);
}

TEST_F(GlOcclusionDepth, SettingsAndOptionsThatItDoesNotHaveAreRefused) {
  const scene s = flat_scene();
  const auto invalid = error_code::invalid_argument;
  const window_depth_settings paper = paper_depth_settings();
  expect_refused(s, {}, {}, invalid, "gradient_scheme::central_difference");
  window_depth_settings exact = paper;
  exact.parallax = parallax_mode::exact;
  expect_refused(s, exact, {}, invalid, "parallax_mode::paper_lookup");
  window_depth_settings refined = paper;
  refined.refine_maximum = true;
  expect_refused(s, refined, {}, invalid, "refine_maximum");
  expect_refused(s, paper, {.contacts = 257}, invalid, "1 to 256");
  expect_refused(s, paper, {.triangles = 1}, invalid, "triangles");
  expect_refused(s, paper, {.depth_bits = 32}, invalid, "16 or 24");
  expect_refused(s, paper, {.depth_range_m = -1.0}, invalid, "depth_range_m");
  expect_refused(s, paper_depth_settings(33), {.packed = true}, invalid, "quarters");
  window_depth_settings step = paper;
  step.difference_step_m = 1e-4;
  expect_refused(s, step, {.moved = moved_heights::reused}, invalid, "difference_step_m");
  window_depth_settings origin = paper;
  origin.origin = rotation_origin::centre_of_mass;
  expect_refused(s, origin, {.moved = moved_heights::reused}, invalid, "origin");
  // A device whose textures are large enough for so many tiles lacks the memory.
  context->limit_memory(64'000'000);
  expect_refused(s, paper_depth_settings(512), {.contacts = 256}, error_code::limit_exceeded, "fewer contacts");
  context->limit_memory(0);
  expect_refused({}, paper, {}, invalid, "no probe");
  const std::size_t before = context->device_bytes();
  context->limit_memory(before + 300'000);
  expect_refused(s, paper, {}, error_code::limit_exceeded, "the tiles of heights needs");
  EXPECT_EQ(context->device_bytes(), before);
  context->limit_memory(0);
  EXPECT_FALSE(occlusion_depth::make(nullptr, s));
}

}  // namespace
}  // namespace asperity::gl
