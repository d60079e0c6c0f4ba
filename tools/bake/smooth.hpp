// Takes the fine relief off a mesh before it is simplified.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Passes before a mesh is simplified: in proportion to the ratio of the triangle counts, at most 400.
/// The filter's response to a wave of length L is exp(-n (0.26 k^2 - 0.02 k)) after n passes, k = (pi h / L)^2 and h
/// the edge of a fine triangle. With this many passes it takes nine tenths off waves shorter than a third of a coarse
/// edge at a ratio of 100, a sixth at 1000. Twice as many closed cracks along coarse edges further, but rounded
/// silhouettes by more than the bake's own error.
[[nodiscard]] std::size_t smoothing_passes(std::size_t full_triangles, std::size_t coarse_triangles) noexcept;

/// Vertex positions after `passes` of Taubin's filter: a step towards the mean of the neighbours and a slightly longer
/// step back, so that waves vanish while the volume stays. Connectivity is not touched.
/// @source G. Taubin, A signal processing approach to fair surface design, 1995
/// @return empty where the bake was cancelled
[[nodiscard]] std::vector<vec3> smooth(const triangle_mesh& mesh, std::size_t passes, unsigned threads,
                                       stage_monitor& monitor);

}  // namespace asperity::bake
