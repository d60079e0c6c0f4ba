// The low-resolution geometry that collision detection and the depth windows work on, and its convex pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

/// A triangle of the coarse mesh: indices of its vertices, counter-clockwise seen from outside, and the texture
/// coordinates of its corners (glTF convention: origin at the first texel's outer corner, both in [0, 1]).
/// Corners have their own coordinates because an atlas cuts the surface where the geometry is whole.
struct coarse_triangle {
  std::array<std::uint32_t, 3> vertex{};
  std::array<vec2, 3> uv{};
};

/// Closed, 2-manifold, welded triangle mesh in the body frame, metres. It holds no relief (paper, section 6.2).
struct coarse_mesh {
  std::vector<vec3> positions;
  std::vector<coarse_triangle> triangles;

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(positions, triangles); }
};

/// Corner positions of triangle t. @pre t < mesh.triangles.size()
[[nodiscard]] inline std::array<vec3, 3> corners(const coarse_mesh& mesh, std::size_t t) noexcept {
  const auto& v = mesh.triangles[t].vertex;
  return {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
}

/// Outward normal of a triangle times twice its area.
[[nodiscard]] inline vec3 area_normal(const std::array<vec3, 3>& c) noexcept {
  return glm::cross(c[1] - c[0], c[2] - c[0]);
}

/// Convex hull of a connected set of coarse triangles. Every coarse triangle belongs to exactly one piece.
/// A piece may be flat (a single triangle is common in concave areas): then `hull` triangulates the convex polygon on
/// the outward side only.
struct convex_piece {
  std::vector<vec3> vertices;  ///< hull vertices, body frame, metres
  std::vector<std::array<std::uint32_t, 3>>
      hull;                              ///< hull faces: indices into vertices, counter-clockwise from outside
  std::vector<std::uint32_t> triangles;  ///< coarse triangles that this piece covers
  bool flat = false;                     ///< all vertices in one plane within the decomposition's tolerance

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(vertices, hull, triangles); }
};

}  // namespace asperity
