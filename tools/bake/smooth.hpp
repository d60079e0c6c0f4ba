// Takes the fine relief off a mesh before it is simplified.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Passes that remove nine tenths of a relief whose wavelength is a third of a coarse triangle's edge, and more of a
/// finer one. Twice as many, for longer waves, cost more at sharp edges than they gain: the error of the CAD part rose
/// by a third. A pass multiplies a wave by 1 - (pi h / wavelength)^2 / 2, h the edge of a fine triangle; the squared
/// ratio of the edges is the ratio of the triangle counts.
[[nodiscard]] std::size_t smoothing_passes(std::size_t full_triangles, std::size_t coarse_triangles) noexcept;

/// Vertex positions after `passes` halfway steps towards the mean of the neighbours, followed by the same filter on
/// what they removed, which is then put back (twicing, J. W. Tukey, 1977): a wave that the filter multiplies by g comes
/// out as 2 g - g^2 of itself. Fine waves vanish all the same, while curvature and volume stay where the filter alone
/// would have shrunk them. Connectivity is not touched.
/// @return empty where the bake was cancelled
[[nodiscard]] std::vector<vec3> smooth(const triangle_mesh& mesh, std::size_t passes, unsigned threads,
                                       stage_monitor& monitor);

}  // namespace asperity::bake
