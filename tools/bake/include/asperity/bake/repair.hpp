// Repairs that a user asks for by name; a bake never repairs silently. Component asperity::bake.
#pragma once

#include <cstddef>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Largest hole, in edges, that close_holes fills: in a larger one a flat patch would not resemble the surface.
inline constexpr std::size_t largest_hole_edges = 500;

struct hole_report {
  std::size_t holes = 0;
  std::size_t triangles_added = 0;
  double area_added_m2 = 0.0;        ///< area of the new triangles
  double largest_m = 0.0;            ///< longest distance across one hole
  std::size_t triangles_turned = 0;  ///< that were wound against their neighbours, so that borders can be followed
};

/// Closes every hole with a triangulation over the hole's own vertices; no vertex is added or moved. It is
/// searched for the fewest folds, onto itself or onto the triangles around, and of those for the least area.
/// Texture coordinates are dropped where a hole was closed: the new triangles have none.
/// @return bad_mesh where a hole has more than largest_hole_edges edges, or where edges are shared by more than two
///         triangles (a hole has no border there that could be followed), or where a surface has only one side
/// @source Barequet and Sharir 1995 (least-area triangulation of a hole by dynamic programming);
///         Liepa 2003 (angles first, then area)
[[nodiscard]] result<hole_report> close_holes(triangle_mesh& mesh);

}  // namespace asperity::bake
