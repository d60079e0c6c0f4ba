// Does the surface around a hole go on across it, or end in an edge?
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {

/// The surface around a rim, against a flat patch over the hole.
struct rim_shape {
  double edge_sine = 0.0;  ///< of the angle between the two, RMS over the rim; 1 for more than a right angle
  /// How much the surface around curves towards the patch, in units of what closes the hole: 1 beside the missing cap of
  /// a sphere, 0 at the end of a tube.
  double curving = 0.0;
};

/// @param mesh    closed: its first triangles are those that `net` was made of
/// @param border  open halfedges of the hole in `net`, each of which ends where the next begins
/// @param patch   the triangles over it
[[nodiscard]] rim_shape shape_of_rim(const triangle_mesh& mesh, const connectivity& net,
                                     std::span<const std::uint32_t> border, std::span<const index_triangle> patch);

}  // namespace asperity::bake
