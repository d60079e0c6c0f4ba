// A patch over a hole, apart from its mesh: made as fine as the surface around it, and faired into that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {

struct hole_patch {
  std::vector<vec3> positions;    ///< of the rim, in its order, then of the vertices that were added
  std::size_t rim = 0;            ///< how many are the rim's
  std::vector<double> spacing_m;  ///< length that edges should have at each vertex
  std::vector<index_triangle> triangles;
};

/// What lies around the rim: vertices below hole_patch::rim are the rim's, the others are `positions` from there on.
struct patch_surroundings {
  std::vector<vec3> positions;
  std::vector<index_triangle> triangles;  ///< those with a vertex of the rim
};

/// Adds vertices where triangles are larger than the spacing at their corners, and exchanges edges for the other diagonal
/// where that makes the angles larger. The rim stays.
/// @param taken  edges that the surface around has between vertices of the rim, the smaller first: none is made again
/// @param most   vertices; the spacing is widened until about so many are enough
/// @source Liepa 2003, section 5
void refine_patch(hole_patch& patch, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& taken,
                  std::size_t most);

/// Moves the added vertices to where the patch bends least, as a thin plate that is clamped to the surface around does:
/// the sum over all vertices of the squared Laplacian, with cotangent weights, is least.
/// @return false where the system could not be solved; nothing has moved then
/// @source Liepa 2003, section 6
[[nodiscard]] bool fair_patch(hole_patch& patch, const patch_surroundings& around);

}  // namespace asperity::bake
