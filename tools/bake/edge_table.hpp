// The triangles at each edge, whichever way they run along it and however many they are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "bake/halfedges.hpp"

namespace asperity::bake {

/// A halfedge under its two vertices, the smaller first.
struct edge_use {
  std::uint32_t low, high, halfedge;
};

/// All halfedges, those of one edge beside each other and in order. Triangles that name a vertex twice are left out.
[[nodiscard]] inline std::vector<edge_use> edges_of(std::span<const index_triangle> triangles) {
  std::vector<edge_use> out;
  out.reserve(3 * triangles.size());
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    const index_triangle& t = triangles[h / 3];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    const auto [low, high] = std::minmax({origin_of(triangles, h), origin_of(triangles, next_halfedge(h))});
    out.push_back({low, high, h});
  }
  std::ranges::sort(out, {}, [](const edge_use& e) { return std::tuple(e.low, e.high, e.halfedge); });
  return out;
}

/// Calls visit(uses) for every edge.
template <class Visit>
void for_each_edge(std::span<const edge_use> edges, const Visit& visit) {
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
    visit(edges.subspan(i, j - i));
  }
}

/// The sets of a partition, each named by its smallest member.
class disjoint_sets {
 public:
  explicit disjoint_sets(std::size_t n) : parent_(n) {
    for (std::uint32_t i = 0; i < n; ++i) parent_[i] = i;
  }
  [[nodiscard]] std::uint32_t find(std::uint32_t i) noexcept {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) noexcept {
    a = find(a);
    b = find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace asperity::bake
