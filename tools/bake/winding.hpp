// Triangles that wind against their neighbours, turned.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "bake/halfedges.hpp"

namespace asperity::bake {

/// Turns triangles until any two that share an edge wind the same way. In each connected surface the fewer are turned,
/// so that the way most of it faces is kept. Edges with one triangle, or with more than two, join nothing.
/// @return how many were turned; nothing, and the triangles as they were, where a surface has only one side
[[nodiscard]] std::optional<std::size_t> make_winding_consistent(std::span<index_triangle> triangles);

/// The sentence with which a report tells of it.
[[nodiscard]] inline std::string winding_remark(std::size_t turned) {
  return turned == 1 ? "1 triangle was wound against its neighbours and has been turned"
                     : std::to_string(turned) + " triangles were wound against their neighbours and have been turned";
}

}  // namespace asperity::bake
