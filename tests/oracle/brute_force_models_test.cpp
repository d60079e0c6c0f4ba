// The whole chain against the full-resolution meshes: models baked by the command, contacts found by the library, and
// its depth compared with the brute-force depth of the two originals in the same window.
#include <cmath>
#include <cstdio>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "oracle/benchmark_bodies.hpp"
#include "oracle/brute_force.hpp"
#include "support/built_renderers.hpp"

namespace {

using namespace asperity;
using oracle::original_and_bake;
using oracle::percentile;
using oracle::reach;

constexpr int poses_per_pair = 70;
constexpr int grid = oracle::comparison_grid;

TEST(brute_force_models, depth_agrees_with_the_full_resolution_meshes) {
  struct pair {
    const char *probe, *fixed;
    std::uint64_t seed;
  };
  oracle::print_heading();
  int poses = 0;
  for (const pair& p : {pair{"block", "gear", 11}, pair{"file", "cad_part", 12}, pair{"hammer", "torus", 13}}) {
    const original_and_bake a = oracle::load_benchmark_body(p.probe);
    const original_and_bake b = oracle::load_benchmark_body(p.fixed);
    ASSERT_TRUE(a.model && b.model);
    const oracle::comparison r = oracle::compare_with_originals(a, b, poses_per_pair, p.seed);
    oracle::print_row(a, b, r);
    poses += r.poses;
    EXPECT_EQ(r.beyond, 0) << p.probe << " on " << p.fixed << " (seed " << p.seed << ")";
    EXPECT_EQ(r.disagreed, 0) << p.probe << " on " << p.fixed;
    EXPECT_LE(percentile(r.on_grid_m, 0.5), r.rms_error_m) << "half the contacts are as good as the bakes' mean error";
    EXPECT_GT(percentile(r.untextured_m, 0.5), 5.0 * percentile(r.on_grid_m, 0.5)) << "a lost texture would not show";
  }
  EXPECT_GE(poses, 200);
}

// Coarse triangles of a body that face `towards_w` within `reach_m` of a point: what a single contact there may be.
std::vector<std::uint32_t> patch_near(const coarse_mesh& mesh, const pose& T, const vec3& centre_w,
                                      const vec3& towards_w, double reach_m) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    const vec3 low = glm::min(T * c[0], glm::min(T * c[1], T * c[2])) - reach_m;
    const vec3 high = glm::max(T * c[0], glm::max(T * c[1], T * c[2])) + reach_m;
    const bool near = glm::all(glm::lessThan(low, centre_w)) && glm::all(glm::lessThan(centre_w, high));
    if (near && glm::dot(T.rotation * area_normal(c), towards_w) > 0.0) out.push_back(t);
  }
  return out;
}

// The shared potential knows no windows. Where it tells a single contact, its depth is that of the originals along its
// direction, in a window about it.
TEST(brute_force_models, a_single_contact_of_the_shared_potential_is_as_deep_as_the_originals) {
  struct pair {
    const char *probe, *fixed;
    std::uint64_t seed;
  };
  constexpr double half_window_m = 0.002;
  std::printf("  %-20s %9s %14s %9s %9s %7s\n", "pair", "contacts", "error um: p50", "p95", "max", "share");
  int contacts = 0;
  for (const pair& which : {pair{"block", "gear", 21}, pair{"file", "cad_part", 22}, pair{"hammer", "torus", 23}}) {
    const original_and_bake a = oracle::load_benchmark_body(which.probe);
    const original_and_bake b = oracle::load_benchmark_body(which.fixed);
    ASSERT_TRUE(a.model && b.model);
    auto made = test_support::build_renderer({a.model, {b.model}});
    ASSERT_TRUE(made) << made.error().message;
    const double tau_m = made->settings().tau_m;
    const std::array<pose, 1> fixed{};
    std::mt19937_64 rng(which.seed);
    std::vector<double> errors_m;
    double worst_share = 0.0;
    int beyond = 0;
    for (int attempt = 0; errors_m.size() < 25 && attempt < 150; ++attempt) {
      pose T_wa;
      tick t;
      if (!oracle::touching_pose(*made, rng, T_wa) || made->step({T_wa, fixed}, t) != status::ok) continue;
      if (t.contacts.size() != 1) continue;
      contact_window window = t.contacts[0].window;
      window.half_size_m = half_window_m;
      const auto patch_a = patch_near(a.model->mesh, T_wa, window.centre_w, window.n_ab_w, half_window_m);
      const auto patch_b = patch_near(b.model->mesh, {}, window.centre_w, -window.n_ab_w, half_window_m);
      const auto truth = oracle::measure_brute_force({&a.full, &a.model->mesh, patch_a, T_wa, reach(a)},
                                                     {&b.full, &b.model->mesh, patch_b, {}, reach(b)}, window, grid, 3);
      if (truth.samples == 0) continue;
      const auto along_n = [](double slope) { return std::hypot(1.0, std::min(slope, 1.0)); };
      const double bound = 2.0 * tau_m + along_n(truth.dense.slope_a) * a.model->report.max_error_m +
                           along_n(truth.dense.slope_b) * b.model->report.max_error_m;
      const double error = std::fabs(t.depths[0].soft_depth_m - truth.dense.depth_m);
      errors_m.push_back(error);
      worst_share = std::max(worst_share, error / bound);
      if (error > bound) {
        ++beyond;
        std::printf("    attempt %d: depth %.4f mm, originals %.4f mm, bound %.4f mm\n", attempt,
                    t.depths[0].soft_depth_m * 1e3, truth.dense.depth_m * 1e3, bound * 1e3);
      }
    }
    contacts += static_cast<int>(errors_m.size());
    std::printf("  %-8s on %-8s %9zu %14.1f %9.1f %9.1f %7.2f\n", which.probe, which.fixed, errors_m.size(),
                percentile(errors_m, 0.5) * 1e6, percentile(errors_m, 0.95) * 1e6, percentile(errors_m, 1.0) * 1e6,
                worst_share);
    EXPECT_EQ(beyond, 0) << which.probe << " on " << which.fixed << " (seed " << which.seed << ")";
  }
  EXPECT_GE(contacts, 40);
}

}  // namespace
