// The whole chain against the full-resolution meshes: models baked by the command, contacts found by the library, and
// its depth compared with the brute-force depth of the two originals in the same window.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "oracle/brute_force.hpp"
#include "oracle/model_poses.hpp"

namespace {

using namespace asperity;
using namespace asperity::oracle;

constexpr int poses_per_pair = 70;
constexpr int grid = 64;
constexpr int refinement = 5;

struct row {
  int poses = 0, contacts = 0;
  int beyond = 0;                    // further from the true depth than sampling and bakes explain
  double worst_share = 0.0;          // of that bound
  double rms_error_m = 0.0;          // of both bakes
  std::vector<double> errors_m;      // from the originals on the finer grid
  std::vector<double> on_grid_m;     // from the originals on the same grid: what sampling has no part in
  std::vector<double> untextured_m;  // the same of the coarse surfaces alone: what a lost texture would show
};

triangle_mesh bare(const coarse_mesh& mesh) {
  triangle_mesh out{mesh.positions, {}, {}};
  for (const coarse_triangle& t : mesh.triangles) out.triangles.push_back(t.vertex);
  return out;
}

row compare(const std::string& probe_name, const std::string& fixed_name, std::uint64_t seed) {
  const loaded_body a = load(probe_name);
  const loaded_body b = load(fixed_name);
  row out;
  if (a.model == nullptr || b.model == nullptr) return out;
  paper_settings settings;
  settings.depth.grid = grid;
  auto made = make_paper_renderer({a.model, {b.model}}, settings);
  if (!made) {
    ADD_FAILURE() << made.error().message;
    return out;
  }
  out.rms_error_m = a.model->report.rms_error_m + b.model->report.rms_error_m;
  const triangle_mesh bare_a = bare(a.model->mesh);
  const triangle_mesh bare_b = bare(b.model->mesh);
  const std::array<pose, 1> fixed{};
  std::mt19937_64 rng(seed);
  for (int attempt = 0; out.poses < poses_per_pair && attempt < 4 * poses_per_pair; ++attempt) {
    pose T_wa;
    if (!touching_pose(*made, rng, T_wa)) continue;
    ++out.poses;
    tick t;
    if (made->step({T_wa, fixed}, t) != status::ok) {
      ADD_FAILURE() << "a pose that was found once is not found again";
      continue;
    }
    for (std::size_t i = 0; i < t.contacts.size(); ++i) {
      const contact& c = t.contacts[i];
      const penetration& p = t.depths[i];
      const auto truth = measure_brute_force({&a.full, &a.model->mesh, made->contacts().patch_a(c), T_wa, reach(a)},
                                             {&b.full, &b.model->mesh, made->contacts().patch_b(c), {}, reach(b)},
                                             c.window, grid, refinement);
      if (has(p.flags, depth_flag::no_overlap) || truth.samples == 0) {
        EXPECT_EQ(has(p.flags, depth_flag::no_overlap), truth.samples == 0) << probe_name << " pose " << out.poses;
        continue;
      }
      ++out.contacts;
      // A bake's error is a distance across the surface; along n a slope makes it longer. A wall, where that has no
      // limit, counts as 45 degrees.
      const auto along_n = [](double slope) { return std::hypot(1.0, std::min(slope, 1.0)); };
      // What the grid misses of the originals themselves, and the bakes' own largest errors.
      const double bound = (truth.dense.depth_m - truth.grid.depth_m) +
                           along_n(truth.dense.slope_a) * a.model->report.max_error_m +
                           along_n(truth.dense.slope_b) * b.model->report.max_error_m;
      const double error = std::fabs(p.depth_m - truth.dense.depth_m);
      out.worst_share = std::max(out.worst_share, error / bound);
      if (error > bound) {
        ++out.beyond;
        std::printf("    pose %d contact %zu: depth %.4f mm, originals %.4f mm, on the same grid %.4f mm\n", out.poses,
                    i, p.depth_m * 1e3, truth.dense.depth_m * 1e3, truth.grid.depth_m * 1e3);
      }
      const auto untextured =
          measure_brute_force({&bare_a, &a.model->mesh, made->contacts().patch_a(c), T_wa, reach(a)},
                              {&bare_b, &b.model->mesh, made->contacts().patch_b(c), {}, reach(b)}, c.window, grid, 1);
      out.errors_m.push_back(error);
      out.on_grid_m.push_back(std::fabs(p.depth_m - truth.grid.depth_m));
      out.untextured_m.push_back(std::fabs(untextured.grid.depth_m - truth.grid.depth_m));
    }
  }
  return out;
}

TEST(brute_force_models, depth_agrees_with_the_full_resolution_meshes) {
  struct pair {
    const char *probe, *fixed;
    std::uint64_t seed;
  };
  std::printf("  |depth - originals| in um: on a grid %d times finer, on the same grid, and there without texture\n",
              refinement);
  std::printf("  %-20s %5s %8s %10s %7s %7s %6s %9s %7s %7s %9s\n", "pair", "poses", "contacts", "finer: p50", "p95",
              "max", "share", "same: p50", "p95", "max", "bare: p50");
  int poses = 0;
  for (const pair& p : {pair{"block", "gear", 11}, pair{"file", "cad_part", 12}, pair{"hammer", "torus", 13}}) {
    const row r = compare(p.probe, p.fixed, p.seed);
    const auto um = [](const std::vector<double>& v, double share) { return percentile(v, share) * 1e6; };
    std::printf("  %-8s on %-8s %5d %8d %10.1f %7.1f %7.1f %6.2f %9.2f %7.2f %7.2f %9.1f\n", p.probe, p.fixed, r.poses,
                r.contacts, um(r.errors_m, 0.5), um(r.errors_m, 0.95), um(r.errors_m, 1.0), r.worst_share,
                um(r.on_grid_m, 0.5), um(r.on_grid_m, 0.95), um(r.on_grid_m, 1.0), um(r.untextured_m, 0.5));
    poses += r.poses;
    EXPECT_EQ(r.beyond, 0) << p.probe << " on " << p.fixed << " (seed " << p.seed << ")";
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
    const loaded_body a = load(which.probe);
    const loaded_body b = load(which.fixed);
    ASSERT_TRUE(a.model && b.model);
    auto made = make_renderer({a.model, {b.model}});
    ASSERT_TRUE(made) << made.error().message;
    const double tau_m = made->depth().settings().tau_m;
    const std::array<pose, 1> fixed{};
    std::mt19937_64 rng(which.seed);
    std::vector<double> errors_m;
    double worst_share = 0.0;
    int beyond = 0;
    for (int attempt = 0; errors_m.size() < 25 && attempt < 150; ++attempt) {
      pose T_wa;
      tick t;
      if (!touching_pose(*made, rng, T_wa) || made->step({T_wa, fixed}, t) != status::ok) continue;
      if (t.contacts.size() != 1) continue;
      contact_window window = t.contacts[0].window;
      window.half_size_m = half_window_m;
      const auto patch_a = patch_near(a.model->mesh, T_wa, window.centre_w, window.n_ab_w, half_window_m);
      const auto patch_b = patch_near(b.model->mesh, {}, window.centre_w, -window.n_ab_w, half_window_m);
      const auto truth = measure_brute_force({&a.full, &a.model->mesh, patch_a, T_wa, reach(a)},
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
