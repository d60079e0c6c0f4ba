// What the tests of occlusion_depth share: windows onto two textured plates, and a context for every test.
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "asperity/gl/occlusion_depth.hpp"
#include "hardware/gl/seeded_contacts.hpp"
#include "support/gl_context.hpp"

namespace asperity::gl {

/// The first seed whose plates lie over each other in the whole window.
[[nodiscard]] inline test_support::seeded_contacts overlapping() {
  const window_depth_settings settings = paper_depth_settings(16);
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
  [[nodiscard]] occlusion_depth make(const scene& s, const occlusion_settings& o = {},
                                     const window_depth_settings& settings = paper_depth_settings(32)) {
    auto made = occlusion_depth::make(context, s, settings, o);
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  void expect_refused(const scene& s, const window_depth_settings& settings, const occlusion_settings& o,
                      error_code code, const std::string& words) {
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

/// Two plates without any relief.
[[nodiscard]] inline scene flat_scene() {
  test_support::plate_spec a, b;
  a.half_x = a.half_y = 0.005;
  a.texels = b.texels = 64;
  return {test_support::make_plate(a), {test_support::make_plate(b)}};
}

}  // namespace asperity::gl
