// The border of a hole, and triangles over it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {

/// The open halfedges of every hole, in the order in which the triangles around it run along its border.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> find_holes(const connectivity& around);

/// The same, cut where a border meets itself in a vertex: each passes a vertex once.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> find_simple_holes(const triangle_mesh& mesh,
                                                                        const connectivity& around);

/// Edges of the largest hole that is filled in one go.
inline constexpr std::size_t largest_hole_edges = 500;

/// Appends triangles over the hole: those with the fewest folds, and of these the least area (dynamic programming, as
/// the cube of its edges) up to `largest_hole_edges`; a larger hole is filled over every few of its vertices first, and then
/// between these. @param budget  of steps, counted down; where it runs out, fewer vertices are taken at a time
/// @return the area added
double fill_hole(triangle_mesh& mesh, const std::vector<std::uint32_t>& hole, double& budget);

/// Longest distance between two vertices of the hole; of more than 2,000, the diagonal of their box.
[[nodiscard]] double widest_distance(const triangle_mesh& mesh, const std::vector<std::uint32_t>& hole);

}  // namespace asperity::bake
