// Edges of more than two triangles and vertices where surfaces touch, parted into sheets (Guéziec et al. 2001: cut
// everywhere, then stitch what belongs together).
#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "bake/edge_table.hpp"
#include "bake/repair_steps.hpp"

namespace asperity::bake {
namespace {

constexpr double largest_wall_share = 0.35;  // of the area of all that hangs together: what is larger is the body

struct region {
  double area = 0.0;
  double area_of_piece = 0.0;  // of all that it hangs together with
  bounds box;
  std::vector<std::uint32_t> triangles;
  std::vector<std::size_t> hangs_on;  // numbers of edges of more than two
};

/// Triangles that join across edges of two.
std::vector<region> regions_of(const triangle_mesh& mesh, const std::vector<edge_use>& edges,
                               std::vector<std::size_t>& uses_at) {
  disjoint_sets sets(mesh.triangles.size());
  for_each_edge(edges, [&](std::span<const edge_use> uses) {
    if (uses.size() == 2) sets.join(uses[0].halfedge / 3, uses[1].halfedge / 3);
  });
  disjoint_sets pieces = sets;
  for_each_edge(edges, [&](std::span<const edge_use> uses) {
    for (const edge_use& e : uses) pieces.join(uses[0].halfedge / 3, e.halfedge / 3);
  });
  std::vector<double> area_of_piece(mesh.triangles.size(), 0.0);
  std::vector<std::uint32_t> number(mesh.triangles.size(), no_halfedge);
  std::vector<region> out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    const std::uint32_t root = sets.find(t);
    if (root == t) {
      number[t] = static_cast<std::uint32_t>(out.size());
      out.push_back({0.0, 0.0, {c[0], c[0]}, {}, {}});
    }
    region& r = out[number[root]];
    r.triangles.push_back(t);
    const double area = 0.5 * glm::length(area_normal(c));
    r.area += area;
    area_of_piece[pieces.find(t)] += area;
    for (const vec3& p : c) {
      r.box.low = glm::min(r.box.low, p);
      r.box.high = glm::max(r.box.high, p);
    }
  }
  for_each_edge(edges, [&](std::span<const edge_use> uses) {
    if (uses.size() < 3) return;
    for (const edge_use& e : uses) out[number[sets.find(e.halfedge / 3)]].hangs_on.push_back(uses_at.size());
    uses_at.push_back(uses.size());
  });
  for (region& r : out) r.area_of_piece = area_of_piece[pieces.find(r.triangles.front())];
  return out;
}

/// The triangles at one edge, in the order in which they stand around it.
struct leaf {
  double angle;
  bool up;  // runs from the lower vertex to the higher one
  std::uint32_t halfedge;
};
std::vector<leaf> around_edge(const triangle_mesh& mesh, std::span<const edge_use> uses) {
  const vec3 a = mesh.positions[uses[0].low];
  const vec3 axis = normalised(mesh.positions[uses[0].high] - a);
  std::vector<leaf> out;
  vec3 x{0.0};
  for (const edge_use& e : uses) {
    const vec3 to = mesh.positions[origin_of(mesh.triangles, previous_halfedge(e.halfedge))] - a;
    const vec3 radial = to - glm::dot(to, axis) * axis;
    if (out.empty()) x = normalised(radial);
    const double angle = std::atan2(glm::dot(glm::cross(axis, x), radial), glm::dot(x, radial));
    constexpr double same_angle = 1e-9;  // faces that lie on each other: the order between them is by side
    out.push_back({std::round(angle / same_angle), origin_of(mesh.triangles, e.halfedge) == e.low, e.halfedge});
  }
  std::ranges::sort(out, {}, [](const leaf& l) { return std::tuple(l.angle, !l.up, l.halfedge); });
  return out;
}

/// Couples the two triangles that have material between them, so that bodies that touch along an edge stay apart.
/// The material of one that runs up lies at smaller angles.
void couple(std::vector<leaf> leaves, std::vector<std::uint32_t>& mate) {
  for (bool found = true; found && leaves.size() > 1;) {
    found = false;
    for (std::size_t i = 0; i < leaves.size() && !found; ++i) {
      const std::size_t before = (i + leaves.size() - 1) % leaves.size();
      if (!leaves[i].up || leaves[before].up) continue;
      mate[leaves[i].halfedge] = leaves[before].halfedge;
      mate[leaves[before].halfedge] = leaves[i].halfedge;
      leaves.erase(leaves.begin() + static_cast<std::ptrdiff_t>(std::max(i, before)));
      leaves.erase(leaves.begin() + static_cast<std::ptrdiff_t>(std::min(i, before)));
      found = true;
    }
  }
}

vec3 middle_of(const triangle_mesh& mesh, std::uint32_t h) {
  return 0.5 *
         (mesh.positions[origin_of(mesh.triangles, h)] + mesh.positions[origin_of(mesh.triangles, next_halfedge(h))]);
}

/// Who lies across each halfedge, whichever way it runs.
std::vector<std::uint32_t> couple_all(const triangle_mesh& mesh, repair_report& report) {
  std::vector<std::uint32_t> mate(3 * mesh.triangles.size(), no_halfedge);
  for_each_edge(edges_of(mesh.triangles), [&](std::span<const edge_use> uses) {
    if (uses.size() == 2) {
      mate[uses[0].halfedge] = uses[1].halfedge;
      mate[uses[1].halfedge] = uses[0].halfedge;
    } else if (uses.size() > 2) {
      report.add(repair_kind::split_edge, middle_of(mesh, uses[0].halfedge), 0.0);
      constexpr std::size_t most_leaves = 256;  // coupling is quadratic in them
      if (uses.size() <= most_leaves) couple(around_edge(mesh, uses), mate);
    }
  });
  return mate;
}

/// Gives every fan about a vertex a vertex of its own; open fans share one, so that holes that meet in it stay apart.
void part_fans(triangle_mesh& mesh, const std::vector<std::uint32_t>& mate, repair_report& report) {
  const auto n = static_cast<std::uint32_t>(3 * mesh.triangles.size());
  disjoint_sets fans(n);
  const auto corner_at = [&](std::uint32_t h, std::uint32_t v) {
    return origin_of(mesh.triangles, h) == v ? h : next_halfedge(h);
  };
  for (std::uint32_t h = 0; h < n; ++h) {
    if (mate[h] == no_halfedge) continue;
    for (const std::uint32_t end : {h, next_halfedge(h)})
      fans.join(end, corner_at(mate[h], origin_of(mesh.triangles, end)));
  }
  std::vector<bool> open(n, false);
  for (std::uint32_t h = 0; h < n; ++h) {
    if (mate[h] != no_halfedge) continue;
    open[fans.find(h)] = true;
    open[fans.find(next_halfedge(h))] = true;
  }
  std::vector<std::uint32_t> of_fan(n, no_halfedge);
  std::vector<bool> taken(mesh.positions.size(), false);
  std::vector<std::uint32_t> shared(mesh.positions.size(), no_halfedge);
  std::vector<index_triangle> renamed = mesh.triangles;
  for (std::uint32_t c = 0; c < n; ++c) {
    const std::uint32_t v = origin_of(mesh.triangles, c);
    const std::uint32_t fan = fans.find(c);
    std::uint32_t& name = of_fan[fan];
    if (name == no_halfedge) {
      if (open[fan] && shared[v] != no_halfedge) {
        name = shared[v];
      } else if (!taken[v]) {
        taken[v] = true;
        name = v;
      } else {
        name = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(vec3(mesh.positions[v]));
        report.add(repair_kind::split_vertex, mesh.positions[v], 0.0);
      }
      if (open[fan]) shared[v] = name;
    }
    renamed[c / 3][c % 3] = name;
  }
  mesh.triangles = std::move(renamed);
}

/// Two sheets that have both ends of an edge in common: each gets a middle of its own.
void part_long_pinches(triangle_mesh& mesh, const std::vector<std::uint32_t>& mate) {
  std::vector<bool> used(mesh.triangles.size(), false);
  for_each_edge(edges_of(mesh.triangles), [&](std::span<const edge_use> uses) {
    if (uses.size() < 3) return;
    for (const edge_use& e : uses) {
      const std::uint32_t g = mate[e.halfedge];
      if (g == no_halfedge || g < e.halfedge || used[e.halfedge / 3] || used[g / 3]) continue;
      used[e.halfedge / 3] = used[g / 3] = true;
      const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(middle_of(mesh, e.halfedge));
      split_at_edge(mesh, e.halfedge / 3, e.halfedge % 3, middle, 0.5);
      split_at_edge(mesh, g / 3, g % 3, middle, 0.5);
    }
  });
}

}  // namespace

// What hangs on edges of three and leaves edges of two behind: fins, and walls within. The smallest first.
void drop_inner_walls(triangle_mesh& mesh, repair_report& report) {
  constexpr int most_rounds = 16;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<edge_use> edges = edges_of(mesh.triangles);
    std::vector<std::size_t> uses_at;
    std::vector<region> regions = regions_of(mesh, edges, uses_at);
    if (uses_at.empty()) return;
    std::erase_if(regions,
                  [&](const region& r) { return r.hangs_on.empty() || r.area > largest_wall_share * r.area_of_piece; });
    std::ranges::sort(regions, {}, [](const region& r) { return std::pair(r.area, r.triangles.front()); });
    std::vector<bool> gone(mesh.triangles.size(), false);
    bool any = false;
    for (const region& r : regions) {
      if (!std::ranges::all_of(r.hangs_on, [&](std::size_t e) { return uses_at[e] % 2 == 1 && uses_at[e] >= 3; }))
        continue;
      for (const std::size_t e : r.hangs_on) --uses_at[e];
      for (const std::uint32_t t : r.triangles) gone[t] = true;
      report.add(repair_kind::inner_wall, mesh.positions[mesh.triangles[r.triangles.front()][0]], r.box.diagonal(),
                 r.triangles.size());
      any = true;
    }
    if (!any) return;
    drop_triangles(mesh, gone);
  }
}

void part_sheets(triangle_mesh& mesh, repair_report& report) {
  std::vector<std::uint32_t> mate = couple_all(mesh, report);
  part_fans(mesh, mate, report);
  part_long_pinches(mesh, mate);
}

}  // namespace asperity::bake
