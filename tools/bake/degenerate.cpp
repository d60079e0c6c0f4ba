// Triangles without area, and the T-junctions that they hide.
#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "bake/edge_table.hpp"
#include "bake/repair_steps.hpp"

namespace asperity::bake {
namespace {

bool names_one_twice(const index_triangle& t) noexcept { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// Zero-area triangles that name a vertex twice go; edges without length are collapsed first. @return whether any
bool collapse(triangle_mesh& mesh, double reach, std::vector<bool>& flat, repair_report& report) {
  disjoint_sets same(mesh.positions.size());
  bool collapsed = false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!flat[t]) continue;
    const index_triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k];
      const std::uint32_t b = v[(k + 1) % 3];
      const double length = glm::length(mesh.positions[a] - mesh.positions[b]);
      if (a == b || length > no_length_per_reach * reach) continue;
      same.join(a, b);
      collapsed = true;
      report.add(repair_kind::degenerate, mesh.positions[a], length, 0);
    }
  }
  if (collapsed)
    for (index_triangle& t : mesh.triangles)
      for (std::uint32_t& v : t) v = same.find(v);
  std::vector<bool> gone(mesh.triangles.size(), false);
  bool any = false;
  for (std::size_t t = 0; t < gone.size(); ++t) {
    gone[t] = names_one_twice(mesh.triangles[t]);
    if (!gone[t]) continue;
    any = true;
    report.add(repair_kind::degenerate, mesh.positions[mesh.triangles[t][0]], 0.0);
  }
  if (any) drop_triangles(mesh, gone);
  return any || collapsed;
}

/// The corner of a triangle that lies on its longest edge.
std::uint32_t middle_corner(const triangle_mesh& mesh, std::uint32_t t) {
  const auto c = corners(mesh.positions, mesh.triangles[t]);
  std::uint32_t middle = 0;
  double longest = -1.0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double length = glm::length(c[(k + 1) % 3] - c[(k + 2) % 3]);
    if (length <= longest) continue;
    longest = length;
    middle = k;
  }
  return middle;
}

/// Three corners on a line: the one in the middle is set into all other triangles along the longest edge, and the
/// triangle goes. The edges of what is left are shorter, so that this ends. @return whether any
bool split_caps(triangle_mesh& mesh, const std::vector<bool>& flat, repair_report& report) {
  const std::vector<edge_use> edges = edges_of(mesh.triangles);
  const std::size_t count = mesh.triangles.size();
  std::vector<bool> used(count, false);
  std::vector<bool> gone(count, false);
  bool any = false;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (!flat[t] || used[t]) continue;
    const std::uint32_t k = middle_corner(mesh, t);
    const index_triangle v = mesh.triangles[t];
    const auto [low, high] = std::minmax({v[(k + 1) % 3], v[(k + 2) % 3]});
    const auto ends = [](const edge_use& e) { return std::pair(e.low, e.high); };
    const std::pair edge(low, high);
    const std::span<const edge_use> uses(std::ranges::lower_bound(edges, edge, {}, ends),
                                         std::ranges::upper_bound(edges, edge, {}, ends));
    if (std::ranges::any_of(uses, [&](const edge_use& e) { return used[e.halfedge / 3]; })) continue;
    const vec3 a = mesh.positions[low];
    const vec3 d = mesh.positions[high] - a;
    const double s = std::clamp(glm::dot(mesh.positions[v[k]] - a, d) / glm::dot(d, d), 0.0, 1.0);
    for (const edge_use& e : uses) {
      const std::uint32_t other = e.halfedge / 3;
      used[other] = true;
      const bool same = origin_of(mesh.triangles, previous_halfedge(e.halfedge)) == v[k];
      if (other == t || same) {
        gone[other] = true;
        report.add(repair_kind::degenerate, mesh.positions[v[k]], 0.0);
      } else {
        split_at_edge(mesh, other, e.halfedge % 3, v[k], origin_of(mesh.triangles, e.halfedge) == low ? s : 1.0 - s);
      }
    }
    any = true;
  }
  gone.resize(mesh.triangles.size(), false);
  if (any) drop_triangles(mesh, gone);
  return any;
}

}  // namespace

void drop_degenerate(triangle_mesh& mesh, repair_report& report) {
  constexpr int most_passes = 64;
  const double reach = reach_of(mesh);
  for (int pass = 0; pass < most_passes; ++pass) {
    std::vector<bool> flat(mesh.triangles.size(), false);
    bool any = false;
    for (std::size_t t = 0; t < flat.size(); ++t) {
      flat[t] = has_no_area(corners(mesh.positions, mesh.triangles[t]), reach);
      any = any || flat[t];
    }
    if (!any) return;
    if (!collapse(mesh, reach, flat, report) && !split_caps(mesh, flat, report)) return;
  }
}

}  // namespace asperity::bake
