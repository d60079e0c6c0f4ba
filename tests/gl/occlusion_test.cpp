#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>

#include "asperity/gl/occlusion_depth.hpp"
#include "gl/seeded_contacts.hpp"
#include "support/counted_news.hpp"
#include "support/gl_context.hpp"

namespace asperity::gl {
namespace {

static_assert(std::is_nothrow_move_constructible_v<occlusion_depth> &&
                  std::is_nothrow_move_assignable_v<occlusion_depth>,
              "it sits in a renderer");

/// The first seed whose plates lie over each other in the whole window.
test_support::seeded_contacts overlapping() {
  const depth_settings settings = paper_depth_settings(16);
  for (std::uint64_t seed = 106;; ++seed) {
    auto s = test_support::make_seeded_contacts(seed, 4, 4, 192, 1);
    cpu_depth reference(s.bodies, settings);
    if (test_support::measure_one_by_one(reference, s)[0].samples == 256) return s;
  }
}

/// Several windows onto the same two textured plates.
struct windows {
  test_support::seeded_contacts seeded = overlapping();
  contact_set contacts{{.contacts = 300, .triangles = 1U << 16}};

  explicit windows(std::size_t count) {
    const contact& c = seeded.contacts.contacts().front();
    for (std::size_t i = 0; i < count; ++i) {
      contact moved = c;
      moved.window.half_size_m = 0.003 + 5e-4 * static_cast<double>(i % 4);
      moved.window.centre_w +=
          (1e-3 * static_cast<double>(i % 5) - 2e-3) * c.window.u_w + 1e-3 * static_cast<double>(i % 3) * c.window.v_w;
      EXPECT_TRUE(contacts.add(moved, seeded.contacts.patch_a(c), seeded.contacts.patch_b(c)));
    }
  }
  [[nodiscard]] const scene& bodies() const { return seeded.bodies; }
  [[nodiscard]] scene_pose at() const { return {seeded.T_wa.front(), std::span(seeded.T_wb).first(1)}; }
  template <class Backend>
  [[nodiscard]] std::vector<penetration> measure(Backend& backend) const {
    std::vector<penetration> out(contacts.size());
    EXPECT_EQ(backend.measure(at(), contacts, out), status::ok);
    return out;
  }
};

class GlOcclusionDepth : public test_support::gl_test {
 protected:
  [[nodiscard]] occlusion_depth make(const scene& s, const occlusion_options& o = {},
                                     const depth_settings& settings = paper_depth_settings(32)) {
    auto made = occlusion_depth::make(context, s, settings, o);
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  void expect_refused(const scene& s, const depth_settings& settings, const occlusion_options& o, error_code code,
                      const std::string& words) {
    const auto made = occlusion_depth::make(context, s, settings, o);
    ASSERT_FALSE(made) << words;
    EXPECT_EQ(made.error().code, code);
    EXPECT_NE(made.error().message.find(words), std::string::npos) << made.error().message;
  }
  static void expect_same(const penetration& p, const penetration& q) {
    EXPECT_EQ(p.depth_m, q.depth_m);
    EXPECT_EQ(p.samples, q.samples);
    EXPECT_EQ(p.flags, q.flags);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(p.gradient[i], q.gradient[i]);
  }
  static void expect_nothing(const penetration& p) {
    EXPECT_EQ(p.flags, depth_flag::no_overlap);
    EXPECT_EQ(p.depth_m, 0.0);
    EXPECT_EQ(p.samples, 0U);
    EXPECT_EQ(test_support::largest_entry(p), 0.0);
  }
};

std::optional<double> largest(const occlusion_tile& tile) {
  std::optional<double> out;
  for (const double v : tile.values_m) {
    if (!std::isnan(v) && (!out || v > *out)) out = v;
  }
  return out;
}

TEST_F(GlOcclusionDepth, TheSearchFindsWhatReadingTheDepthBufferFinds) {
  const windows w(7);
  for (const bool packed : {false, true}) {
    occlusion_depth backend = make(w.bodies(), {.packed = packed});
    const std::vector<penetration> found = w.measure(backend);
    const auto tiles = backend.read_tiles();
    ASSERT_TRUE(tiles) << tiles.error().message;
    const vec3 centre = centre_of_mass_w(w.bodies(), w.at().T_wa);
    int seen = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (has(found[i].flags, depth_flag::no_overlap)) continue;
      ++seen;
      const auto& differences = (*tiles)[i].differences;
      ASSERT_EQ(differences.size(), 11U);
      ASSERT_EQ((*tiles)[i].heights.size(), 12U);
      EXPECT_EQ(differences[0].values_m.size(), packed ? 256U : 1024U);
      EXPECT_EQ(largest(differences[0]), found[i].depth_m);
      detail::moved_depths moved;
      for (std::size_t m = 0; m < moved.size(); ++m) moved[m] = largest(differences[m + 1]);
      const contact_window& window = w.contacts.contacts()[i].window;
      const vec6 g = detail::gradient_of(moved, window, centre, window.centre_w, found[i].depth_m, backend.step_m(i),
                                         backend.step_rad(i));
      for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(g[k], found[i].gradient[k]);
    }
    EXPECT_GE(seen, 4);
  }
}

TEST_F(GlOcclusionDepth, HeightsThatAreReadBackAreThoseOfTheTwoBodies) {
  const windows w(2);
  for (const bool packed : {false, true}) {
    occlusion_depth backend = make(w.bodies(), {.packed = packed});
    const std::vector<penetration> found = w.measure(backend);
    const auto tiles = backend.read_tiles();
    ASSERT_TRUE(tiles) << tiles.error().message;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto& heights = (*tiles)[i].heights;
      EXPECT_EQ(heights[0].name, "B");
      EXPECT_EQ(heights[1].name, "A");
      EXPECT_EQ(heights[11].name, "A turned -n");
      double deepest = -1.0;
      std::uint32_t shared = 0;
      for (std::size_t k = 0; k < heights[0].values_m.size(); ++k) {
        const double d = heights[1].values_m[k] - heights[0].values_m[k];
        if (std::isnan(d)) continue;
        deepest = std::max(deepest, d);
        ++shared;
      }
      EXPECT_EQ(shared, found[i].samples);
      EXPECT_NEAR(deepest, found[i].depth_m, backend.quantum_m(i));
    }
  }
}

TEST_F(GlOcclusionDepth, PackingChangesNoValue) {
  const windows w(5);
  occlusion_depth plain = make(w.bodies()), packed = make(w.bodies(), {.packed = true});
  const std::vector<penetration> p = w.measure(plain), q = w.measure(packed), again = w.measure(plain);
  for (std::size_t i = 0; i < p.size(); ++i) {
    expect_same(p[i], q[i]);
    expect_same(p[i], again[i]);  // two backends in one context do not disturb each other
  }
}

TEST_F(GlOcclusionDepth, ARoundTripPerBitAndOneForTheOverlap) {
  const windows w(3);
  for (const std::uint32_t bits : {16U, 24U}) {
    occlusion_depth backend = make(w.bodies(), {.depth_bits = bits});
    static_cast<void>(w.measure(backend));
    EXPECT_EQ(backend.counters().round_trips, 1 + bits);
    // One per tile and bit, one more for what lies inside the border; rings of samples and their number before.
    EXPECT_EQ(backend.counters().queries, 3 * (12 * bits + 16 + 1));
    static_cast<void>(w.measure(backend));
    EXPECT_EQ(backend.counters().round_trips, 2 * (1 + bits));
    EXPECT_EQ(backend.counters().ticks, 2U);
    EXPECT_EQ(backend.counters().contacts, 6U);
  }
  occlusion_depth backend = make(w.bodies());
  const contact_set none;
  EXPECT_EQ(backend.measure(w.at(), none, {}), status::ok);
  EXPECT_EQ(backend.counters().round_trips, 0U);
}

TEST_F(GlOcclusionDepth, ATickAllocatesNothing) {
  const windows w(4);
  occlusion_depth backend = make(w.bodies());
  std::vector<penetration> out(w.contacts.size());
  // Drivers put compiling off: llvmpipe does some of it in the third call.
  for (int i = 0; i < 4; ++i) ASSERT_EQ(backend.measure(w.at(), w.contacts, out), status::ok);
  const std::size_t heap = backend.heap_bytes(), device = context->device_bytes();
  const std::size_t before = test_support::news_in_this_thread();
  status said = status::ok;
  for (int i = 0; i < 3; ++i) said = backend.measure(w.at(), w.contacts, out);
  EXPECT_EQ(test_support::news_in_this_thread(), before);
  EXPECT_EQ(said, status::ok);
  EXPECT_EQ(backend.heap_bytes(), heap);
  EXPECT_EQ(context->device_bytes(), device);
}

scene flat_scene() {
  test_support::plate_spec a, b;
  a.half_x = a.half_y = 0.005;
  a.texels = b.texels = 64;
  return {test_support::make_plate(a), {test_support::make_plate(b)}};
}

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

TEST_F(GlOcclusionDepth, SixHeightFunctionsAreEnoughForTranslations) {
  windows w(1);
  const contact_window& window = w.contacts.contacts()[0].window;
  depth_settings settings = paper_depth_settings(32);
  for (const bool packed : {false, true}) {
    occlusion_depth six = make(w.bodies(), {.moved = moved_heights::reused, .packed = packed}, settings);
    const penetration p = w.measure(six)[0];
    const auto tiles = six.read_tiles();
    ASSERT_TRUE(tiles) << tiles.error().message;
    EXPECT_EQ((*tiles)[0].heights.size(), 6U);
    EXPECT_EQ((*tiles)[0].differences.size(), 11U);
    EXPECT_EQ((*tiles)[0].heights[2].name, "A turned +u");

    depth_settings by_a_sample = settings;
    by_a_sample.difference_step_m = six.step_m(0);
    EXPECT_NEAR(six.step_m(0), 2.0 * window.half_size_m / 32, 1e-15);
    cpu_depth reference(w.bodies(), by_a_sample);
    const penetration q = w.measure(reference)[0];
    const double quantum = six.quantum_m(0);
    EXPECT_NEAR(p.depth_m, q.depth_m, quantum);
    const vec3 off = p.gradient.linear - q.gradient.linear;
    EXPECT_LE(std::max(std::fabs(glm::dot(off, window.u_w)), std::fabs(glm::dot(off, window.v_w))),
              2.0 * quantum / six.step_m(0));
    const vec3 centre = centre_of_mass_w(w.bodies(), w.at().T_wa);
    const vec6 d = p.gradient - q.gradient;
    const vec3 turned = d.angular - glm::cross(window.centre_w - centre, d.linear);
    const double allowed = 2.0 * quantum / six.step_rad(0);
    EXPECT_LE(std::fabs(glm::dot(turned, window.u_w)), allowed);
    EXPECT_LE(std::fabs(glm::dot(turned, window.v_w)), allowed);
    // Resampled, not rendered: near, but not within the bound.
    EXPECT_LE(std::fabs(glm::dot(turned, window.n_ab_w)), 0.1 * window.half_size_m);
    std::printf("about n: %g m/rad rendered, %g resampled\n", glm::dot(q.gradient.angular, window.n_ab_w),
                glm::dot(q.gradient.angular, window.n_ab_w) + glm::dot(turned, window.n_ab_w));
  }
}

TEST_F(GlOcclusionDepth, TilesOfManyContactsTakeSeveralColumns) {
  const windows w(3);
  // 256 tiles of 70 pixels do not fit above each other into 16384.
  const depth_settings settings = paper_depth_settings(64);
  occlusion_depth few = make(w.bodies(), {.contacts = 3, .moved = moved_heights::reused}, settings);
  occlusion_depth many =
      make(w.bodies(), {.contacts = 256, .triangles = 400, .moved = moved_heights::reused}, settings);
  const std::vector<penetration> p = w.measure(few), q = w.measure(many);
  for (std::size_t i = 0; i < p.size(); ++i) expect_same(p[i], q[i]);
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
  const depth_settings paper = paper_depth_settings();
  expect_refused(s, {}, {}, invalid, "gradient_scheme::central_difference");
  depth_settings exact = paper;
  exact.parallax = parallax_mode::exact;
  expect_refused(s, exact, {}, invalid, "parallax_mode::paper_lookup");
  depth_settings refined = paper;
  refined.refine_maximum = true;
  expect_refused(s, refined, {}, invalid, "refine_maximum");
  expect_refused(s, paper, {.contacts = 257}, invalid, "1 to 256");
  expect_refused(s, paper, {.triangles = 1}, invalid, "triangles");
  expect_refused(s, paper, {.depth_bits = 32}, invalid, "16 or 24");
  expect_refused(s, paper, {.depth_range_m = -1.0}, invalid, "depth_range_m");
  expect_refused(s, paper_depth_settings(33), {.packed = true}, invalid, "quarters");
  depth_settings step = paper;
  step.difference_step_m = 1e-4;
  expect_refused(s, step, {.moved = moved_heights::reused}, invalid, "difference_step_m");
  depth_settings origin = paper;
  origin.origin = rotation_origin::centre_of_mass;
  expect_refused(s, origin, {.moved = moved_heights::reused}, invalid, "origin");
  expect_refused(s, paper_depth_settings(512), {.contacts = 256}, error_code::limit_exceeded, "fewer contacts");
  expect_refused({}, paper, {}, invalid, "no probe");
  const std::size_t before = context->device_bytes();
  context->limit_memory(before + 300'000);
  expect_refused(s, paper, {}, error_code::limit_exceeded, "the tiles of heights needs");
  EXPECT_EQ(context->device_bytes(), before);
  context->limit_memory(0);
  EXPECT_FALSE(occlusion_depth::make(nullptr, s));
}

TEST(GlOcclusionEs, CannotReadItsTiles) {
  const auto context = open_context({.dialect = dialect::es});
  if (!context) GTEST_SKIP() << context.error().message;
  const windows w(1);
  auto made = occlusion_depth::make(*context, w.bodies(), paper_depth_settings(16));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(w.measure(*made)[0].samples, 1U);
  const auto tiles = made->read_tiles();
  ASSERT_FALSE(tiles);
  EXPECT_EQ(tiles.error().code, error_code::unsupported);
  EXPECT_EQ(take_errors((*context)->gl()), "");
}

}  // namespace
}  // namespace asperity::gl
