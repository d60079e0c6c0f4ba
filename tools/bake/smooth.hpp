// Takes the fine relief off a mesh before it is simplified.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Passes that remove relief of wavelengths below half the edge of a coarse triangle.
/// One pass widens the filter's Gaussian by h^2 / 4 (h: edge of a fine triangle); damping such a wave tenfold takes a
/// width of 0.17 coarse edges, and the squared ratio of the edges is the ratio of the triangle counts.
[[nodiscard]] std::size_t smoothing_passes(std::size_t full_triangles, std::size_t coarse_triangles) noexcept;

/// Vertex positions after `passes` of Taubin's filter: a step towards the mean of the neighbours and a slightly longer
/// step back, so that waves vanish while the volume stays. Connectivity is not touched.
/// @source G. Taubin, A signal processing approach to fair surface design, 1995
/// @return empty where the bake was cancelled
[[nodiscard]] std::vector<vec3> smooth(const triangle_mesh& mesh, std::size_t passes, unsigned threads,
                                       stage_monitor& monitor);

}  // namespace asperity::bake
