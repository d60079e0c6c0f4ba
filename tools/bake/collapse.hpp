// Edge collapse that cannot change the topology or turn a triangle over.
#pragma once

#include <cstddef>
#include <optional>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Simplifies a closed 2-manifold to `target` triangles, or as near as its topology and shape allow. Edges go in the
/// order of their quadric error; one stays where its collapse would pinch the surface, turn a triangle by 60 degrees or
/// more or against the surface it came from, or leave a sliver.
/// Our own, because the result has to be sound: meshoptimizer 0.18 is much faster, but on every one of our models it
/// turned triangles over, and on most it pinched the surface, at every level of detail.
/// Takes some 130 bytes of memory a triangle, the mesh itself included.
/// @source M. Garland and P. Heckbert, Surface simplification using quadric error metrics, 1997
/// @pre closed 2-manifold without degenerate triangles
/// @return nothing where the bake was cancelled
[[nodiscard]] std::optional<triangle_mesh> collapse_edges(triangle_mesh mesh, std::size_t target,
                                                          stage_monitor& monitor, unsigned threads = 1);

}  // namespace asperity::bake
