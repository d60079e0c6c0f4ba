#include "bake/halfedges.hpp"

#include <algorithm>
#include <utility>

namespace asperity::bake {
namespace {

// A halfedge under the smaller of its two vertices.
struct edge_entry {
  std::uint32_t far_vertex;
  std::uint32_t halfedge;
  friend bool operator<(const edge_entry& a, const edge_entry& b) noexcept {
    return std::pair(a.far_vertex, a.halfedge) < std::pair(b.far_vertex, b.halfedge);
  }
};

void pair_edge(std::span<const index_triangle> triangles, std::span<const edge_entry> group, connectivity& out) {
  const std::uint32_t h = group[0].halfedge;
  if (group.size() == 1) return out.open_edges.add(h);
  if (group.size() > 2) return out.non_manifold_edges.add(h);
  const std::uint32_t g = group[1].halfedge;
  if (origin_of(triangles, h) == origin_of(triangles, g)) return out.misoriented_edges.add(h);
  out.mate[h] = g;
  out.mate[g] = h;
}

void number_components(connectivity& out) {
  const std::size_t count = out.mate.size() / 3;
  out.component.assign(count, no_halfedge);
  std::vector<std::uint32_t> open;
  for (std::size_t seed = 0; seed < count; ++seed) {
    if (out.component[seed] != no_halfedge) continue;
    const auto number = static_cast<std::uint32_t>(out.components++);
    out.component[seed] = number;
    open.push_back(static_cast<std::uint32_t>(seed));
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t m = out.mate[3 * t + k];
        if (m == no_halfedge || out.component[m / 3] != no_halfedge) continue;
        out.component[m / 3] = number;
        open.push_back(m / 3);
      }
    }
  }
}

// Turning about a vertex once must pass every triangle that uses it.
void check_fans(std::span<const index_triangle> triangles, const std::vector<std::uint32_t>& valence,
                connectivity& out) {
  std::vector<bool> seen(valence.size(), false);
  for (std::uint32_t h = 0; h < out.mate.size(); ++h) {
    const std::uint32_t v = origin_of(triangles, h);
    if (seen[v]) continue;
    seen[v] = true;
    std::uint32_t fan = 0;
    std::uint32_t turning = h;
    do {
      ++fan;
      turning = out.mate[previous_halfedge(turning)];
    } while (turning != h && turning != no_halfedge);
    if (turning == h && fan != valence[v]) out.non_manifold_vertices.add(v);
  }
}

}  // namespace

connectivity connect(std::span<const index_triangle> triangles, std::size_t vertex_count) {
  connectivity out;
  const std::size_t halfedges = 3 * triangles.size();
  out.mate.assign(halfedges, no_halfedge);

  std::vector<std::uint32_t> first(vertex_count + 1, 0);
  std::vector<std::uint32_t> valence(vertex_count, 0);
  const auto ends = [&](std::uint32_t h) {
    return std::minmax({origin_of(triangles, h), origin_of(triangles, next_halfedge(h))});
  };
  for (std::uint32_t h = 0; h < halfedges; ++h) {
    ++first[ends(h).first + 1];
    ++valence[origin_of(triangles, h)];
  }
  for (std::size_t v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
  std::vector<edge_entry> entries(halfedges);
  std::vector<std::uint32_t> cursor(first.begin(), first.end() - 1);
  for (std::uint32_t h = 0; h < halfedges; ++h) {
    const auto [low, high] = ends(h);
    entries[cursor[low]++] = {high, h};
  }

  long edges = 0;
  long vertices = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    vertices += valence[v] > 0;
    const std::span<edge_entry> bucket(entries.data() + first[v], first[v + 1] - first[v]);
    std::sort(bucket.begin(), bucket.end());
    for (std::size_t i = 0, j = 0; i < bucket.size(); i = j) {
      while (j < bucket.size() && bucket[j].far_vertex == bucket[i].far_vertex) ++j;
      pair_edge(triangles, bucket.subspan(i, j - i), out);
      ++edges;
    }
  }
  out.euler = vertices - edges + static_cast<long>(triangles.size());
  number_components(out);
  check_fans(triangles, valence, out);
  return out;
}

}  // namespace asperity::bake
