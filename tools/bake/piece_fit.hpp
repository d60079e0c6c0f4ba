// How well convex pieces stand for the mesh that they were made of.
#pragma once

#include <optional>
#include <vector>

#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Metres.
struct piece_fit {
  double surface_to_hull_max_m = 0.0;  ///< deepest that a triangle lies within the hull of its piece
  double bridged_air_max_m = 0.0;      ///< farthest that a hull stands off the mesh, outside of it
};

/// Samples every triangle against the hull that covers it, and every hull face against the mesh, at most spacing_m
/// apart and finer on small ones. @pre spacing_m > 0; every triangle is in exactly one piece
/// @return empty where the bake was cancelled
[[nodiscard]] std::optional<piece_fit> measure_fit(const triangle_mesh& mesh, const std::vector<convex_piece>& pieces,
                                                   double spacing_m, stage_monitor& monitor, unsigned threads = 1);

}  // namespace asperity::bake
