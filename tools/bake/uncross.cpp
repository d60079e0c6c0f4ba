// Where one component passes through itself: what crosses is cut out, with a ring around it, and the hole is closed.
#include <algorithm>
#include <utility>

#include "bake/edge_table.hpp"
#include "bake/halfedges.hpp"
#include "bake/hole_fill.hpp"
#include "bake/repair_steps.hpp"
#include "bake/self_crossing.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

using pair_list = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Crossings within components.
pair_list own_crossings(const triangle_mesh& mesh, unsigned threads) {
  const triangle_bvh tree(mesh.positions, mesh.triangles, threads);
  stage_monitor unwatched;
  pair_list pairs = *list_self_crossings(mesh, tree, threads, most_listed_crossings, unwatched);
  if (pairs.empty()) return pairs;
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  std::erase_if(pairs, [&](const auto& p) { return net.component[p.first] != net.component[p.second]; });
  return pairs;
}

std::vector<bool> with_rings(const triangle_mesh& mesh, const pair_list& pairs, int rings) {
  std::vector<bool> gone(mesh.triangles.size(), false);
  for (const auto& [a, b] : pairs) gone[a] = gone[b] = true;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<bool> touched(mesh.positions.size(), false);
    for (std::size_t t = 0; t < gone.size(); ++t)
      if (gone[t])
        for (const std::uint32_t v : mesh.triangles[t]) touched[v] = true;
    for (std::size_t t = 0; t < gone.size(); ++t)
      gone[t] = gone[t] || std::ranges::any_of(mesh.triangles[t], [&](std::uint32_t v) { return touched[v]; });
  }
  return gone;
}

}  // namespace

// Taken only where it helps: the mesh stays closed and 2-manifold with as many components, and fewer triangles cross. What is
// left is told by the bake.
void uncross(triangle_mesh& mesh, const repair_settings& settings, repair_report& report) {
  constexpr int most_rounds = 4;
  constexpr double largest_cut_share = 0.1;  // of the area
  repair_settings flat_patches = settings;   // what bulges may cross again
  flat_patches.smooth_holes = false;
  pair_list pairs = own_crossings(mesh, settings.threads);
  for (int round = 0; round < most_rounds && !pairs.empty(); ++round) {
    const std::vector<bool> gone = with_rings(mesh, pairs, 1 + round);
    double cut = 0.0;
    for (std::size_t t = 0; t < gone.size(); ++t)
      if (gone[t]) cut += 0.5 * glm::length(area_normal(corners(mesh.positions, mesh.triangles[t])));
    if (cut > largest_cut_share * area_of(mesh)) return;
    const connectivity was = connect(mesh.triangles, mesh.positions.size());
    triangle_mesh next = mesh;
    drop_triangles(next, gone);
    repair_report aside;
    part_sheets(next, aside);
    const std::size_t kept = next.triangles.size();
    close_all_holes(next, flat_patches, aside);
    drop_degenerate(next, aside);
    const connectivity net = connect(next.triangles, next.positions.size());
    const double reach = reach_of(next);
    const bool flat = std::ranges::any_of(
        next.triangles, [&](const index_triangle& t) { return has_no_area(corners(next.positions, t), reach); });
    if (!net.closed_manifold() || flat || net.components != was.components || kept >= next.triangles.size()) continue;
    const pair_list left = own_crossings(next, settings.threads);
    if (left.size() >= pairs.size()) continue;
    // How far the surface moved: from the vertices that were cut out to what is there now.
    double moved = 0.0;
    const triangle_bvh tree(next.positions, next.triangles, settings.threads);
    for (std::size_t t = 0; t < gone.size(); ++t)
      if (gone[t])
        for (const std::uint32_t v : mesh.triangles[t])
          moved = std::max(moved, tree.closest(mesh.positions[v]).distance_m);
    const auto c = corners(mesh.positions, mesh.triangles[pairs.front().first]);
    report.add(repair_kind::crossing, (c[0] + c[1] + c[2]) / 3.0, moved, pairs.size() - left.size());
    report.triangles_added += aside.triangles_added;
    report.area_added_m2 += aside.area_added_m2;
    mesh = std::move(next);
    pairs = left;
  }
}

}  // namespace asperity::bake
