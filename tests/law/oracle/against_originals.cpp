#include "law/oracle/against_originals.hpp"

#include <cstdio>
#include <stdexcept>
#include <utility>

#include "asperity/window/window_renderer.hpp"
#include "law/oracle/approach.hpp"
#include "law/oracle/brute_force.hpp"

namespace asperity::oracle {
namespace {

triangle_mesh bare(const coarse_mesh& mesh) {
  triangle_mesh out{mesh.positions, {}, {}};
  for (const coarse_triangle& t : mesh.triangles) out.triangles.push_back(t.vertex);
  return out;
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

window_renderer make_compared(const original_and_bake& a, const original_and_bake& b) {
  window_renderer_settings settings;
  settings.depth.grid = comparison_grid;
  auto made = make_window_renderer({a.model, {b.model}}, settings);
  if (!made) throw std::runtime_error(made.error().message);
  return std::move(made).value();
}

std::vector<compared_contact> compare_contacts(window_renderer& feel, const original_and_bake& a,
                                               const original_and_bake& b, const pose& T_wa, double steepest,
                                               int& disagreed) {
  const triangle_mesh bare_a = bare(a.model->mesh), bare_b = bare(b.model->mesh);
  const std::array<pose, 1> fixed{};
  std::vector<compared_contact> out;
  tick t;
  if (feel.step({T_wa, fixed}, t) != status::ok) throw std::runtime_error("a tick failed");
  for (std::size_t i = 0; i < t.contacts.size(); ++i) {
    const contact& c = t.contacts[i];
    const penetration& p = t.depths[i];
    const auto patch_a = feel.found().patch_a(c), patch_b = feel.found().patch_b(c);
    const auto truth = measure_brute_force({&a.full, &a.model->mesh, patch_a, T_wa, reach(a)},
                                           {&b.full, &b.model->mesh, patch_b, {}, reach(b)}, c.window, comparison_grid,
                                           comparison_refinement);
    if (has(p.flags, depth_flag::no_overlap) || truth.samples == 0) {
      disagreed += has(p.flags, depth_flag::no_overlap) != (truth.samples == 0);
      continue;
    }
    const auto along_n = [&](double slope) { return std::hypot(1.0, std::min(slope, steepest)); };
    const auto untextured =
        measure_brute_force({&bare_a, &a.model->mesh, patch_a, T_wa, reach(a)},
                            {&bare_b, &b.model->mesh, patch_b, {}, reach(b)}, c.window, comparison_grid, 1);
    // What the grid misses of the originals themselves, and the bakes' own largest errors.
    out.push_back({p.depth_m, truth.dense.depth_m, truth.grid.depth_m, untextured.grid.depth_m,
                   (truth.dense.depth_m - truth.grid.depth_m) +
                       along_n(truth.dense.slope_a) * a.model->report.max_error_m +
                       along_n(truth.dense.slope_b) * b.model->report.max_error_m});
  }
  return out;
}

comparison compare_with_originals(const original_and_bake& a, const original_and_bake& b, int poses, std::uint64_t seed,
                                  double steepest) {
  comparison out;
  out.rms_error_m = a.model->report.rms_error_m + b.model->report.rms_error_m;
  auto feel = make_compared(a, b);
  approach_sampler sampler("contacts of " + a.name + " on " + b.name, a.full, b.full);
  for (; out.poses < poses; ++out.poses) {
    const approach on = sampler.draw(seed, static_cast<std::uint64_t>(out.poses));
    const pose T_wa = on.pressed(sampler.between(0.0, 5e-4));
    const auto found = compare_contacts(feel, a, b, T_wa, steepest, out.disagreed);
    out.touching += found.empty() ? 0 : 1;
    for (const compared_contact& c : found) {
      ++out.contacts;
      out.worst_share = std::max(out.worst_share, c.error_m() / c.bound_m);
      if (c.error_m() > c.bound_m) {
        ++out.beyond;
        std::printf("    pose %d: depth %.4f mm, originals %.4f mm, on the same grid %.4f mm; bound %.4f mm\n",
                    out.poses, c.depth_m * 1e3, c.originals_m * 1e3, c.on_grid_m * 1e3, c.bound_m * 1e3);
      }
      out.errors_m.push_back(c.error_m());
      out.on_grid_m.push_back(std::fabs(c.depth_m - c.on_grid_m));
      out.untextured_m.push_back(std::fabs(c.untextured_m - c.on_grid_m));
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
