// The vertices of a wrapped surface, moved onto the original where that harms no triangle.
#pragma once

#include <cstddef>
#include <optional>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// Moves vertices to the closest point of the original, up to half a cell away and where the surfaces face the same
/// way. No triangle turns by more than 60 degrees or loses its height, and none crosses another afterwards: those that
/// would go back. @pre no two triangles of the mesh cross
/// @return false where cancelled
[[nodiscard]] bool fit_to_original(triangle_mesh& mesh, const triangle_mesh& original, const triangle_bvh& tree,
                                   double cell_m, unsigned threads, stage_monitor& monitor);

struct dropped_parts {
  std::size_t cavities = 0;
  std::size_t specks = 0;
  std::size_t left = 0;
};

/// Keeps the outermost surfaces: drops closed ones that face inwards, those within others, and those no larger than
/// `smallest_m`; of several that are all so small the largest stays. Unused vertices go.
/// @pre closed, 2-manifold, no two triangles cross
[[nodiscard]] std::optional<dropped_parts> keep_outermost(triangle_mesh& mesh, double smallest_m, unsigned threads,
                                                          stage_monitor& monitor);

}  // namespace asperity::bake
