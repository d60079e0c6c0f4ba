// Which part of the original the texture does not hold.
#pragma once

#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/fine_points.hpp"
#include "bake/parallel.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

struct lost_area {
  double share = 0.0;       ///< of the original's area
  double part_share = 0.0;  ///< of its largest connected part
  vec3 part_centre{0.0};
  vec3 part_low{0.0};
  vec3 part_high{0.0};
};

/// For each point of the original: does the textured surface have a point that faces the same way, no farther than
/// reach_m? `distance` holds what is known already: each point's distance to the textured surface.
/// @return empty where the bake was cancelled
[[nodiscard]] std::vector<char> find_lost(const fine_points& original, const std::vector<double>& distance,
                                          const triangle_bvh& textured, double reach_m, unsigned threads,
                                          stage_monitor& monitor);

/// Sums up what is lost, and finds its largest part: triangles of the original that share edges.
/// @param full the mesh whose triangles original.source names
[[nodiscard]] lost_area measure_lost(const triangle_mesh& full, const fine_points& original,
                                     const std::vector<char>& lost);

}  // namespace asperity::bake
