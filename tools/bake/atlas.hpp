// Third stage of the bake: texture coordinates for the coarse mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Width, in texels, of the band around every chart that belongs to it alone. A bilinear lookup at the edge of a chart
/// reaches sqrt(2) texels out.
inline constexpr double gutter_texels = 2.0;

/// Texels per side that a bake makes.
inline constexpr std::uint32_t smallest_texture = 16;
inline constexpr std::uint32_t largest_texture = 8192;

struct atlas {
  std::vector<std::array<vec2, 3>> uv;  ///< per triangle and corner, in [0, 1], exact in float32
  std::vector<std::uint32_t> chart;     ///< per triangle
  std::size_t charts = 0;
  double texel_m = 0.0;      ///< edge of a texel on the coarse surface: the root of surface over image area
  double narrow_m = 0.0;     ///< 1 % of the surface has texels narrower than this; texel_m where charts are isometries
  double wide_m = 0.0;       ///< 1 % has texels that are wider; texel_m where charts are isometries
  double utilisation = 0.0;  ///< share of the image that triangles cover
};

/// Cuts the mesh into pairs of triangles across their longest shared edges, unfolds each pair flat, and packs the
/// charts into a square. Every chart is an isometry, so all charts have the same texel density and no distortion.
/// @pre closed 2-manifold without degenerate triangles
/// @return invalid_argument where the texture is too small for so many triangles
[[nodiscard]] result<atlas> make_atlas(const triangle_mesh& coarse, std::uint32_t texture_size);

/// Are so many texels enough for the triangles that they are to cover?
/// @return invalid_argument
[[nodiscard]] result<void> check_room(double texels, std::size_t triangles, std::uint32_t texture_size);

}  // namespace asperity::bake
