// occlusion_depth against the double-precision CPU backend, contact by contact, and the table of what was found.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

#include "asperity/gl/occlusion_depth.hpp"
#include "hardware/gl/seeded_contacts.hpp"
#include "support/extent.hpp"
#include "support/gl_context.hpp"

namespace asperity::gl {
namespace {

struct patch_kind {
  std::uint32_t cells_x, cells_y, texels;
};
constexpr std::array<patch_kind, 8> kinds{
    {{1, 1, 64}, {1, 1, 512}, {2, 1, 128}, {2, 2, 256}, {3, 2, 96}, {3, 3, 384}, {4, 4, 192}, {5, 4, 320}}};

/// In quanta of each contact's depth buffer; gradients times their step.
struct worst_of {
  std::size_t contacts = 0, overlapping = 0, other_flags = 0, other_samples = 0;
  double depth = 0.0, across = 0.0, turning = 0.0;
  double quantum_per_half = 0.0;  ///< largest, of the window's half size
};

/// Gradient about the window's centre, where the turns were made.
vec6 about_window(const vec6& g, const vec3& window_centre_w, const vec3& centre_of_mass_w) {
  return {g.linear, g.angular - glm::cross(window_centre_w - centre_of_mass_w, g.linear)};
}

double largest(const vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

worst_of run(const char* name, const context_ptr& context, const occlusion_settings& options,
             std::size_t contacts_each) {
  worst_of worst;
  const window_depth_settings settings = paper_depth_settings(32);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto& kind = kinds[k];
    const auto s = test_support::make_seeded_contacts(100 + k, kind.cells_x, kind.cells_y, kind.texels, contacts_each);
    cpu_depth reference(s.bodies, settings);
    auto made = occlusion_depth::make(context, s.bodies, settings, options);
    EXPECT_TRUE(made) << made.error().message;
    if (!made) return worst;
    const std::vector<penetration> wanted = test_support::measure_one_by_one(reference, s);
    contact_set one({.contacts = 1, .triangles = 1U << 12});
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const contact& c = s.contacts.contacts()[i];
      one.clear();
      EXPECT_TRUE(one.add(c, s.contacts.patch_a(c), s.contacts.patch_b(c)));
      penetration p;
      EXPECT_EQ(made->measure({s.T_wa[i], std::span(&s.T_wb[i], 1)}, one, std::span(&p, 1)), status::ok);
      const penetration& q = wanted[i];
      ++worst.contacts;
      worst.other_flags += p.flags != q.flags ? 1 : 0;
      if (context->facts().dialect == dialect::core) worst.other_samples += p.samples != q.samples ? 1 : 0;
      if (has(p.flags | q.flags, depth_flag::no_overlap)) continue;
      ++worst.overlapping;
      const double half = c.window.half_size_m;
      // Where levels are finer than single precision, that is the quantum.
      const double range = made->quantum_m(0) * std::pow(2.0, options.depth_bits);
      const double quantum = std::max(made->quantum_m(0), 3e-7 * (half + range));
      const vec3 centre = centre_of_mass_w(s.bodies, s.T_wa[i]);
      const vec6 off = about_window(p.gradient - q.gradient, c.window.centre_w, centre);
      const auto note = [](double& to, double error) { to = std::max(to, error); };
      note(worst.depth, std::fabs(p.depth_m - q.depth_m) / quantum);
      note(worst.across, largest(off.linear) * made->step_m(0) / quantum);
      note(worst.turning, largest(off.angular) * made->step_rad(0) / quantum);
      note(worst.quantum_per_half, quantum / half);
    }
    EXPECT_EQ(take_errors(context->gl()), "");
  }
  std::printf("| %-24s | %5zu | %5zu | %5.2f | %6.2f | %7.2f | %8.1e | %zu | %zu |\n", name, worst.contacts,
              worst.overlapping, worst.depth, worst.across, worst.turning, worst.quantum_per_half, worst.other_flags,
              worst.other_samples);
  return worst;
}

void expect_within_bounds(const worst_of& w) {
  EXPECT_GT(2 * w.overlapping, w.contacts);
  EXPECT_LE(w.depth, 1.0);
  // Two depths that are each off by a quantum; a one-sided quotient has them over one step instead of two.
  EXPECT_LE(w.across, 2.0);
  EXPECT_LE(w.turning, 2.0);
  EXPECT_EQ(w.other_samples, 0U);
  EXPECT_EQ(w.other_flags, 0U);
}

TEST(GlOcclusionAgreement, OverSeededContacts) {
  std::printf(
      "| in quanta, worst of       | cont. | over. | depth | across | turning | quantum  | flags | samples |\n");
  for (const dialect d : {dialect::core, dialect::es}) {
    const auto context = open_context({.dialect = d});
    if (!context) GTEST_SKIP() << context.error().message;
    ASSERT_EQ((*context)->make_current(), status::ok);
    if (d == dialect::es) {
      expect_within_bounds(run("16 bits, ES", *context, {.contacts = 1}, 20));
    } else {
      expect_within_bounds(run("16 bits", *context, {.contacts = 1}, test_support::extent<std::size_t>(60, 250)));
      expect_within_bounds(run("16 bits, packed", *context, {.contacts = 1, .packed = true}, 20));
      expect_within_bounds(run("24 bits", *context, {.contacts = 1, .depth_bits = 24}, 40));
    }
    (*context)->release();
  }
}

}  // namespace
}  // namespace asperity::gl
