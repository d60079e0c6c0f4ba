// Takes the fine relief off a mesh before it is simplified.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Passes that damp relief of a quarter of a coarse edge's wavelength tenfold, and finer relief more: a pass multiplies
/// a wave by 1 + 0.02 k - 0.26 k^2 with k = (pi h / wavelength)^2, h the edge of a fine triangle, and the squared ratio
/// of the edges is the ratio of the triangle counts. Filters that reach longer waves (no step back, or twicing) round
/// off sharp edges: tried on the benchmark, they cost the file on the CAD part two to six times the error in depth.
[[nodiscard]] std::size_t smoothing_passes(std::size_t full_triangles, std::size_t coarse_triangles) noexcept;

/// Vertex positions after `passes` of Taubin's filter: a step towards the mean of the neighbours and a slightly longer
/// step back, so that waves vanish while the volume stays. Connectivity is not touched.
/// @source G. Taubin, A signal processing approach to fair surface design, 1995
/// @return empty where the bake was cancelled
[[nodiscard]] std::vector<vec3> smooth(const triangle_mesh& mesh, std::size_t passes, unsigned threads,
                                       stage_monitor& monitor);

}  // namespace asperity::bake
