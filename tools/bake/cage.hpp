// How far the coarse mesh and the original are apart, and whether that is near enough.
#pragma once

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// A coarse mesh farther than this share of the original's diagonal from it is refused.
inline constexpr double widest_cage_in_diagonals = 0.05;

/// Largest distance between the two surfaces, sampled both ways at vertices and triangle centres.
/// @return bad_mesh where a size differs by 10 or more (units) or the distance exceeds the cage; cancelled
[[nodiscard]] result<double> measure_cage(const triangle_mesh& full, const triangle_bvh& full_tree,
                                          const triangle_mesh& coarse, unsigned threads, stage_monitor& monitor);

}  // namespace asperity::bake
