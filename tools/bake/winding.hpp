// Triangles that wind against their neighbours, turned.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Turns triangle t to its other side; its texture coordinates stay at their corners.
inline void turn(triangle_mesh& mesh, std::size_t t) noexcept {
  std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  if (t < mesh.uvs.size()) std::swap(mesh.uvs[t][1], mesh.uvs[t][2]);
}

/// Turns triangles until any two that share an edge wind the same way. In each connected surface the fewer are turned,
/// so that the way most of it faces is kept. Edges with one triangle, or with more than two, join nothing.
/// @pre texture coordinates for all triangles or for none
/// @return how many were turned; nothing, and the mesh as it was, where a surface has only one side
[[nodiscard]] std::optional<std::size_t> make_winding_consistent(triangle_mesh& mesh);

/// The sentence with which a report tells of it.
[[nodiscard]] inline std::string winding_remark(std::size_t turned) {
  return turned == 1 ? "1 triangle was wound against its neighbours and has been turned"
                     : std::to_string(turned) + " triangles were wound against their neighbours and have been turned";
}

}  // namespace asperity::bake
