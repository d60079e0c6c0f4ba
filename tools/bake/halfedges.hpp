// Which triangle lies across each edge, and what is wrong where none or too many do.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace asperity::bake {

using index_triangle = std::array<std::uint32_t, 3>;

/// Halfedge 3 t + k runs from corner k of triangle t to corner (k + 1) % 3.
inline constexpr std::uint32_t no_halfedge = 0xffffffffU;

[[nodiscard]] constexpr std::uint32_t next_halfedge(std::uint32_t h) noexcept { return h % 3 == 2 ? h - 2 : h + 1; }
[[nodiscard]] constexpr std::uint32_t previous_halfedge(std::uint32_t h) noexcept { return h % 3 == 0 ? h + 2 : h - 1; }

/// Vertex that halfedge h starts from.
[[nodiscard]] inline std::uint32_t origin_of(std::span<const index_triangle> triangles, std::uint32_t h) noexcept {
  return triangles[h / 3][h % 3];
}

/// How often something is wrong, and where it is met first.
struct fault_count {
  std::size_t count = 0;
  std::uint32_t first = 0;  ///< a halfedge, or a vertex for non_manifold_vertices

  void add(std::uint32_t where) noexcept {
    if (count++ == 0) first = where;
  }
};

/// Connectivity of a triangle list. mate[h] is the opposite halfedge, or no_halfedge at an edge that is at fault.
struct connectivity {
  std::vector<std::uint32_t> mate;
  fault_count open_edges;          ///< one triangle only
  fault_count non_manifold_edges;  ///< more than two triangles
  fault_count misoriented_edges;   ///< two triangles that run along it the same way
  fault_count
      non_manifold_vertices;  ///< several fans of triangles meet in the vertex; counted where the edges are sound
  std::vector<std::uint32_t> component;  ///< per triangle, numbered from 0 in order of appearance
  std::size_t components = 0;
  long euler = 0;  ///< vertices - edges + triangles over the vertices in use

  [[nodiscard]] bool closed_manifold() const noexcept {
    return open_edges.count + non_manifold_edges.count + misoriented_edges.count + non_manifold_vertices.count == 0;
  }
};

/// Calls visit(triangle, corner) for the triangles around the vertex that the halfedge starts from; where that is an open
/// one, up to the next open edge.
template <class Visit>
void visit_fan(const connectivity& net, std::uint32_t start, const Visit& visit) {
  std::uint32_t h = start;
  do {
    visit(h / 3, h % 3);
    h = net.mate[previous_halfedge(h)];
  } while (h != start && h != no_halfedge);
}

/// Pairs the halfedges of a triangle list. Linear in its size for meshes of bounded valence.
/// @pre every index < vertex_count; triangles.size() < 2^30
[[nodiscard]] connectivity connect(std::span<const index_triangle> triangles, std::size_t vertex_count);

}  // namespace asperity::bake
