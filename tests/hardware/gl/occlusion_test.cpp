// What occlusion_depth draws and finds: its tiles, its search, its counters.
#include <cmath>
#include <cstdio>
#include <optional>
#include <type_traits>

#include "hardware/gl/occlusion_fixture.hpp"
#include "support/counted_news.hpp"
#include "window/central_difference.hpp"

namespace asperity::gl {
namespace {

static_assert(std::is_nothrow_move_constructible_v<occlusion_depth> &&
                  std::is_nothrow_move_assignable_v<occlusion_depth>,
              "it sits in a renderer");

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

TEST_F(GlOcclusionDepth, SixHeightFunctionsAreEnoughForTranslations) {
  windows w(1);
  const contact_window& window = w.contacts.contacts()[0].window;
  window_depth_settings settings = paper_depth_settings(32);
  for (const bool packed : {false, true}) {
    occlusion_depth six = make(w.bodies(), {.moved = moved_heights::reused, .packed = packed}, settings);
    const penetration p = w.measure(six)[0];
    const auto tiles = six.read_tiles();
    ASSERT_TRUE(tiles) << tiles.error().message;
    EXPECT_EQ((*tiles)[0].heights.size(), 6U);
    EXPECT_EQ((*tiles)[0].differences.size(), 11U);
    EXPECT_EQ((*tiles)[0].heights[2].name, "A turned +u");

    window_depth_settings by_a_sample = settings;
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
  const window_depth_settings settings = paper_depth_settings(64);
  occlusion_depth few = make(w.bodies(), {.contacts = 3, .moved = moved_heights::reused}, settings);
  occlusion_depth many =
      make(w.bodies(), {.contacts = 256, .triangles = 400, .moved = moved_heights::reused}, settings);
  const std::vector<penetration> p = w.measure(few), q = w.measure(many);
  for (std::size_t i = 0; i < p.size(); ++i) expect_same(p[i], q[i]);
}

TEST_F(GlOcclusionDepth, RoomForMoreContactsChangesNoValue) {
  const windows few(2), many(23);
  std::vector<penetration> wanted;
  for (const std::size_t room : {2U, 3U, 16U, 50U}) {
    occlusion_depth backend = make(few.bodies(), {.contacts = room});
    // Many contacts before, few afterwards: what is left over from those is not found again.
    if (room >= 23) {
      const std::vector<penetration> all = many.measure(backend);
      for (std::size_t i = 0; i < wanted.size(); ++i) expect_same(all[i], wanted[i]);
    }
    const std::vector<penetration> found = few.measure(backend);
    if (wanted.empty()) wanted = found;
    for (std::size_t i = 0; i < found.size(); ++i) expect_same(found[i], wanted[i]);
  }
  EXPECT_GT(wanted[0].samples, 0U);
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
