// Relief from the maps of existing assets: height maps and normal maps. Component asperity::bake.
#pragma once

#include <cstddef>
#include <functional>

#include "asperity/bake/relief.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// height = offset_m + scale_m * sample. For whole numbers, whose samples are in [0, 1], black is at offset_m and white
/// scale_m above it; mid grey is the mesh itself where offset_m = -scale_m / 2.
struct height_map_settings {
  double offset_m = 0.0;
  double scale_m = 1.0;
  map_wrap wrap_u = map_wrap::repeat;
  map_wrap wrap_v = map_wrap::repeat;
  /// Asked at least ten times a second, on the calling thread; false cancels.
  std::function<bool()> keep_going = {};
};

/// The relief of a height or displacement map that lies on a mesh by the mesh's own texture coordinates; these may
/// overlap, mirror or leave the unit square. Bilinear between pixels. An image with colours is taken where they are
/// all grey. The relief keeps the image's samples, 4 bytes a pixel: an image that is moved in is not copied.
/// @return bad_mesh (no texture coordinates) | bad_texture (colours, not finite) | invalid_argument | cancelled
[[nodiscard]] result<relief> height_map_relief(const triangle_mesh& mesh, map_image map,
                                               const height_map_settings& settings);

/// Tangent-space normal maps: red along increasing u, blue outwards, green along decreasing v (upwards in the image,
/// as OpenGL and glTF have it) or along increasing v (as DirectX has it).
struct normal_map_settings {
  double scale = 1.0;          ///< factor on red and green, as glTF's normalTexture.scale
  bool green_is_down = false;  ///< DirectX
  map_wrap wrap_u = map_wrap::repeat;
  map_wrap wrap_v = map_wrap::repeat;
  /// Asked several times a second, on the calling thread; false cancels.
  std::function<bool()> keep_going = {};
};

/// How well a normal map could be integrated.
struct normal_map_fit {
  double slope_rms = 0.0;     ///< of the map's slopes over the surface, dimensionless
  double residual_rms = 0.0;  ///< of the part that is no gradient of any height, in the same measure
  double texel_m = 0.0;       ///< edge of the map's texels on the surface, in the mean
  double step_m = 0.0;        ///< longest edge over which heights were solved for
  std::size_t points = 0;     ///< heights solved for
  std::size_t iterations = 0;
  double unmapped_area = 0.0;  ///< share of the surface whose texture coordinates span no area: taken as flat

  [[nodiscard]] double residual_share() const noexcept { return slope_rms > 0.0 ? residual_rms / slope_rms : 0.0; }
};

struct normal_map_relief {
  relief heights;
  normal_map_fit fit;
};

/// The relief whose slopes are those of a normal map, by least squares over the whole surface at once: it has no steps
/// where the map's charts meet, and its mean height is zero on every component of the mesh. A map's slopes hold against
/// its triangles' planes.
/// @pre mesh is closed and 2-manifold (check by baking), no triangle without area
/// @return bad_mesh (no texture coordinates) | bad_texture (grey, not a tangent-space map) | limit_exceeded |
///         cancelled
/// @source Frankot and Chellappa 1988 (projection on integrable slopes); Yserentant 1986 (hierarchical basis)
[[nodiscard]] result<normal_map_relief> integrate_normal_map(const triangle_mesh& mesh, const map_image& map,
                                                             const normal_map_settings& settings);

}  // namespace asperity::bake
