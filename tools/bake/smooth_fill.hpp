// Flat patches over holes exchanged for smooth ones, where the surface around goes on across the hole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {

/// A hole that was closed over its own vertices.
struct closed_hole {
  std::vector<std::uint32_t> border;  ///< its open halfedges, each of which ends where the next begins
  std::size_t triangles = 0;          ///< of the patch
  double area_m2 = 0.0;               ///< of the patch
  bool smooth = false;                ///< the flat patch has been exchanged
};

struct smoothing_limits {
  double made_up_m2 = 0.0;      ///< area that was made up already, apart from the patches
  double largest_share = 0.25;  ///< of the whole area: more is not made up for smoothness
  unsigned threads = 1;         ///< the result does not depend on it
};

/// Exchanges each patch over a hole in a smooth surface for one that is as fine as its surroundings and bends as little as
/// it can. The surface around goes on across the hole where its normals turn towards it half as fast to twice as fast as
/// would close it, and where it does not stand on the hole at a right angle. The flat patch stays elsewhere,
/// where both would be the same, where the smooth one would cross anything or fold, and where more than the limit would
/// be made up.
/// @param net    of the triangles that were there before the patches, which follow them in the order of `holes`
/// @param holes  told there: which are smooth, and what the patches have now
void smooth_patches(triangle_mesh& mesh, const connectivity& net, std::vector<closed_hole>& holes,
                    const smoothing_limits& limits);

}  // namespace asperity::bake
