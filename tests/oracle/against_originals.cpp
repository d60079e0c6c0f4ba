#include "oracle/against_originals.hpp"

#include <cstdio>
#include <gtest/gtest.h>

#include "oracle/brute_force.hpp"
#include "support/built_renderers.hpp"

namespace asperity::oracle {
namespace {

triangle_mesh bare(const coarse_mesh& mesh) {
  triangle_mesh out{mesh.positions, {}, {}};
  for (const coarse_triangle& t : mesh.triangles) out.triangles.push_back(t.vertex);
  return out;
}

}  // namespace

vec3 random_direction(std::mt19937_64& rng) {
  const double z = uniform(rng, -1.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

quat random_rotation(std::mt19937_64& rng) {
  const double u = uniform(rng, 0.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double b = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - u);
  const double s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

comparison compare_with_originals(const original_and_bake& a, const original_and_bake& b, int poses, std::uint64_t seed,
                                  double steepest) {
  comparison out;
  paper_settings settings;
  settings.depth.grid = comparison_grid;
  auto made = test_support::build_paper_renderer({a.model, {b.model}}, settings);
  if (!made) {
    ADD_FAILURE() << made.error().message;
    return out;
  }
  out.rms_error_m = a.model->report.rms_error_m + b.model->report.rms_error_m;
  const triangle_mesh bare_a = bare(a.model->mesh);
  const triangle_mesh bare_b = bare(b.model->mesh);
  const std::array<pose, 1> fixed{};
  std::mt19937_64 rng(seed);
  for (int attempt = 0; out.poses < poses && attempt < 4 * poses; ++attempt) {
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
                                             c.window, comparison_grid, comparison_refinement);
      if (has(p.flags, depth_flag::no_overlap) || truth.samples == 0) {
        out.disagreed += has(p.flags, depth_flag::no_overlap) != (truth.samples == 0);
        continue;
      }
      ++out.contacts;
      const auto along_n = [&](double slope) { return std::hypot(1.0, std::min(slope, steepest)); };
      // What the grid misses of the originals themselves, and the bakes' own largest errors.
      const double bound = (truth.dense.depth_m - truth.grid.depth_m) +
                           along_n(truth.dense.slope_a) * a.model->report.max_error_m +
                           along_n(truth.dense.slope_b) * b.model->report.max_error_m;
      const double error = std::fabs(p.depth_m - truth.dense.depth_m);
      out.worst_share = std::max(out.worst_share, error / bound);
      if (error > bound) {
        ++out.beyond;
        std::printf(
            "    pose %d contact %zu: depth %.4f mm, originals %.4f mm, on the same grid %.4f mm; bound %.4f mm, "
            "slopes %.2f and %.2f\n",
            out.poses, i, p.depth_m * 1e3, truth.dense.depth_m * 1e3, truth.grid.depth_m * 1e3, bound * 1e3,
            truth.dense.slope_a, truth.dense.slope_b);
      }
      const auto untextured = measure_brute_force(
          {&bare_a, &a.model->mesh, made->contacts().patch_a(c), T_wa, reach(a)},
          {&bare_b, &b.model->mesh, made->contacts().patch_b(c), {}, reach(b)}, c.window, comparison_grid, 1);
      out.errors_m.push_back(error);
      out.on_grid_m.push_back(std::fabs(p.depth_m - truth.grid.depth_m));
      out.untextured_m.push_back(std::fabs(untextured.grid.depth_m - truth.grid.depth_m));
    }
  }
  return out;
}

void print_heading() {
  std::printf("  |depth - originals| in um: on a grid %d times finer, on the same grid, and there without texture\n",
              comparison_refinement);
  std::printf("  %-24s %5s %8s %10s %7s %7s %6s %9s %7s %7s %9s\n", "pair", "poses", "contacts", "finer: p50", "p95",
              "max", "share", "same: p50", "p95", "max", "bare: p50");
}

void print_row(const original_and_bake& a, const original_and_bake& b, const comparison& c) {
  const auto um = [](const std::vector<double>& v, double share) { return percentile(v, share) * 1e6; };
  std::printf("  %-24s %5d %8d %10.1f %7.1f %7.1f %6.2f %9.2f %7.2f %7.2f %9.1f\n", (a.name + " on " + b.name).c_str(),
              c.poses, c.contacts, um(c.errors_m, 0.5), um(c.errors_m, 0.95), um(c.errors_m, 1.0), c.worst_share,
              um(c.on_grid_m, 0.5), um(c.on_grid_m, 0.95), um(c.on_grid_m, 1.0), um(c.untextured_m, 0.5));
}

}  // namespace asperity::oracle
