// A mesh cut finer without moving it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

struct refined_mesh {
  std::vector<vec3> positions;  ///< those of the mesh first, then the middles of edges in the order of their making
  std::vector<std::array<std::uint32_t, 2>> parents;  ///< ends of the edge that each added position is the middle of
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> source;  ///< per triangle: the one of the mesh that it is part of
  std::vector<std::array<std::array<float, 3>, 3>> barycentric;  ///< per triangle and corner, in its source; exact
  double longest_edge_m = 0.0;
};

/// Halves every edge that is longer than edge_m, again and again, where possible without more than `most` triangles
/// coming of it: then edges stay longer. Two triangles that share an edge share its new vertices too.
/// @pre edge_m > 0
/// @param keep_going asked on the way; after a false one nothing useful comes back
[[nodiscard]] refined_mesh refine(const triangle_mesh& mesh, double edge_m, std::size_t most,
                                  const std::function<bool()>& keep_going = {});

}  // namespace asperity::bake
