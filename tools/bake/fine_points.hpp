// Surfaces as points close enough to measure with.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/haptic_texture.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// A surface as points, and triangles between them.
struct fine_points {
  triangle_mesh mesh;
  std::vector<double> area;           ///< per point: what it stands for, a third of the triangles around it
  std::vector<std::uint32_t> source;  ///< per triangle of `mesh`: the triangle that it is part of
};

/// The textured surface, sampled through haptic_texture::sample about once per texel, coarse edges and corners
/// included.
[[nodiscard]] fine_points sample_textured(const coarse_mesh& coarse, const haptic_texture& texture);

/// A mesh with points at its vertices, and on triangles with an edge longer than step_m also about step_m apart.
/// The points of such a triangle are its own: they are not shared with its neighbours.
[[nodiscard]] fine_points sample_mesh(const triangle_mesh& mesh, double step_m);

}  // namespace asperity::bake
