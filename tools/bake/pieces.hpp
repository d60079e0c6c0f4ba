// Fifth stage of the bake: the convex pieces that collision detection works on.
#pragma once

#include <cstddef>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Limits as shares of the mesh's diagonal.
struct piece_limits {
  double tolerance = 1e-4;    ///< a vertex of a piece may stand this far above the plane of one of its triangles
  double bridged_air = 4e-3;  ///< a hull may stand this far off the solid where it spans a concave place
  double flat = 1e-5;         ///< a piece no thicker than this is flat
  std::size_t triangles = 0;  ///< most triangles of a piece; 0: as many as there are. Convex components stay whole
};

/// Splits a closed mesh into convex surface patches, grown greedily from the largest triangle over its neighbours, and
/// takes the hull of each. Every triangle belongs to exactly one piece; a component that is convex becomes one piece.
/// Hull vertices are vertices of the mesh.
/// @source S. Ehmann and M. Lin, Accurate and fast proximity queries between polyhedra using convex surface
///         decomposition, 2001
/// @pre closed 2-manifold, outward oriented, without degenerate triangles
/// @return cancelled
[[nodiscard]] result<std::vector<convex_piece>> decompose(const triangle_mesh& mesh, const piece_limits& limits,
                                                          stage_monitor& monitor);

/// The same with other limits than the usual ones, to bring the number of pieces near `count`: for more, pieces of
/// fewer triangles; for fewer, tolerance and bridged air up to 16 times as large. The split of those tried whose number
/// is nearest, and the first of several such. @pre count >= 1
[[nodiscard]] result<std::vector<convex_piece>> decompose_into(const triangle_mesh& mesh, std::size_t count,
                                                               stage_monitor& monitor);

}  // namespace asperity::bake
