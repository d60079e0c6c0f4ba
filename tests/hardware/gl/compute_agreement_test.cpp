// compute_depth against the double-precision CPU backend, contact by contact, and the table of what was found.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <optional>

#include "asperity/gl/compute_depth.hpp"
#include "hardware/gl/seeded_contacts.hpp"
#include "support/extent.hpp"
#include "support/gl_context.hpp"
#include "support/sharp_corner.hpp"

namespace asperity::gl {
namespace {

using GlComputeAgreement = test_support::gl_test;

struct bounds_of {
  double depth;       ///< of the depth range: the window's width
  double soft_depth;  ///< the same
  double gradient;    ///< per component, angular ones at a lever arm of the window's half size
  double curvature;   ///< times tau, the same: the error of the covariance that it is made of
};

struct worst_of {
  std::size_t contacts = 0, overlapping = 0, other_flags = 0, other_samples = 0;
  double depth = 0.0, soft_depth = 0.0, gradient = 0.0, curvature = 0.0, witness = 0.0;
};

vec6 scaled(const vec6& g, double lever_m) { return {g.linear, g.angular / lever_m}; }

double largest(const vec6& g) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 6; ++i) worst = std::max(worst, std::fabs(g[i]));
  return worst;
}

void compare(worst_of& worst, const penetration& p, const penetration& q, const vec3& centre_of_mass_w,
             const contact_window& w, double tau_m) {
  ++worst.contacts;
  worst.other_flags += p.flags != q.flags ? 1 : 0;
  worst.other_samples += p.samples != q.samples ? 1 : 0;
  if (has(p.flags | q.flags, depth_flag::no_overlap)) return;
  ++worst.overlapping;
  const double half = w.half_size_m, lever = glm::length(w.centre_w - centre_of_mass_w) + half;
  worst.depth = std::max(worst.depth, std::fabs(p.depth_m - q.depth_m) / (2.0 * half));
  worst.soft_depth = std::max(worst.soft_depth, std::fabs(p.soft_depth_m - q.soft_depth_m) / (2.0 * half));
  worst.gradient = std::max(worst.gradient, largest(scaled(p.gradient - q.gradient, lever)));
  worst.witness = std::max(worst.witness, glm::length(p.witness_w - q.witness_w) / (2.0 * half));
  for (std::size_t i = 0; i < 6; ++i) {
    const double unit_i = i < 3 ? 1.0 : lever;
    for (std::size_t j = 0; j < 6; ++j) {
      const double unit = unit_i * (j < 3 ? 1.0 : lever);
      const double difference = std::fabs(p.curvature(i, j) - q.curvature(i, j)) / unit;
      worst.curvature = std::max(worst.curvature, tau_m * difference);
    }
  }
}

struct patch_kind {
  std::uint32_t cells_x, cells_y, texels;
};
constexpr std::array<patch_kind, 8> kinds{
    {{1, 1, 64}, {1, 1, 256}, {2, 1, 128}, {2, 2, 256}, {3, 2, 96}, {3, 3, 224}, {4, 4, 192}, {5, 4, 200}}};

void run(const char* name, const context_ptr& context, const window_depth_settings& settings, arithmetic a,
         std::size_t contacts_each, const bounds_of& allowed) {
  worst_of worst;
  std::optional<compute_depth> before;  // kept so that its program is there for the next
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto& kind = kinds[k];
    const auto s = test_support::make_seeded_contacts(100 + k, kind.cells_x, kind.cells_y, kind.texels, contacts_each);
    cpu_depth reference(s.bodies, settings);
    auto made = compute_depth::make(context, s.bodies, settings,
                                    {.contacts = contacts_each, .triangles = 200 * contacts_each, .arithmetic = a});
    ASSERT_TRUE(made) << made.error().message;
    std::vector<pose_pair> at;
    for (std::size_t i = 0; i < s.contacts.size(); ++i) at.push_back({s.T_wa[i], s.T_wb[i]});
    std::vector<penetration> found(s.contacts.size());
    ASSERT_EQ(made->measure_each(at, s.contacts, found), status::ok);
    EXPECT_EQ(made->counters().round_trips, 1U);
    before.emplace(*std::move(made));
    const std::vector<penetration> wanted = test_support::measure_one_by_one(reference, s);
    for (std::size_t i = 0; i < found.size(); ++i) {
      compare(worst, found[i], wanted[i], centre_of_mass_w(s.bodies, s.T_wa[i]), s.contacts.contacts()[i].window,
              reference.tau_m(0));
    }
  }
  std::printf("| %-28s | %5zu | %5zu | %8.1e | %8.1e | %8.1e | %8.1e | %8.1e | %zu | %zu |\n", name, worst.contacts,
              worst.overlapping, worst.depth, worst.soft_depth, worst.gradient, worst.curvature, worst.witness,
              worst.other_flags, worst.other_samples);
  EXPECT_GT(2 * worst.overlapping, worst.contacts);
  EXPECT_LE(worst.depth, allowed.depth);
  EXPECT_LE(worst.soft_depth, allowed.soft_depth);
  EXPECT_LE(worst.gradient, allowed.gradient);
  EXPECT_LE(worst.curvature, allowed.curvature);
  EXPECT_EQ(worst.other_samples, 0U) << "coverage is decided by the CPU backend's code";
  EXPECT_EQ(worst.other_flags, 0U);
}

TEST_F(GlComputeAgreement, OverSeededContacts) {
  std::printf("| %-28s | cont. | over. | depth    | soft d.  | gradient | curv.    | witness  | flags | samples |\n",
              "worst differences");
  const bool doubles = context->facts().double_precision;
  const std::size_t many = test_support::extent<std::size_t>(60, 260), some = test_support::extent<std::size_t>(20, 40);
  const window_depth_settings soft{.grid = 24}, paper{.parallax = parallax_mode::paper_lookup, .grid = 24},
      differences{.gradient = gradient_scheme::central_difference, .grid = 16};
  if (doubles) {
    run("soft max, double", context, soft, arithmetic::double_precision, many, {1e-11, 1e-7, 1e-5, 1e-5});
    run("paper's lookup, double", context, paper, arithmetic::double_precision, some, {1e-11, 1e-7, 1e-5, 1e-5});
    run("central difference, double", context, differences, arithmetic::double_precision, some,
        {1e-11, 1e-11, 1e-10, 0.0});
  }
  run("soft max, single", context, soft, arithmetic::single_precision, many, {1e-6, 1e-6, 2e-2, 1e-1});
  run("central difference, single", context, differences, arithmetic::single_precision, some, {1e-6, 1e-6, 1e-3, 0.0});
}

TEST_F(GlComputeAgreement, PastASharpCorner) {
  test_support::plate_spec fixed;
  fixed.texels = 64;
  for (const double other : {std::numeric_limits<double>::quiet_NaN(), 5e-3}) {
    const scene s{test_support::sharp_corner(vec3(0.0, 0.0, other)), {test_support::make_plate(fixed)}};
    const contact_window w = test_support::window_downwards(8e-4, vec3(7e-4, 0.0, 0.0));
    const pose T_wa{test_support::face_down(), vec3(0.0)};
    const window_depth_settings settings{.grid = 48};
    cpu_depth reference(s, settings);
    const penetration wanted = test_support::measure_whole(reference, s, w, T_wa);
    EXPECT_NEAR(wanted.depth_m, 1e-4, 1e-9);
    EXPECT_FALSE(has(wanted.flags, depth_flag::bad_texel));
    for (const arithmetic a : {arithmetic::automatic, arithmetic::single_precision}) {
      auto made = compute_depth::make(context, s, settings, {.arithmetic = a});
      ASSERT_TRUE(made) << made.error().message;
      const penetration found = test_support::measure_whole(*made, s, w, T_wa);
      EXPECT_EQ(found.flags, wanted.flags);
      EXPECT_EQ(found.samples, wanted.samples);
      EXPECT_NEAR(found.depth_m, wanted.depth_m, 1.6e-9);
    }
  }
}

}  // namespace
}  // namespace asperity::gl
