// Convex parts of a coarse mesh, the units of collision detection.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

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
