// Relief that a mesh does not have in its triangles: a height over every point of it. Component asperity::bake.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "asperity/core/math.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// A point of a mesh, where a height is asked for.
struct relief_point {
  vec3 position{0.0};          ///< m, without the relief
  vec3 normal{0.0};            ///< outward unit normal of the triangle
  std::uint32_t triangle = 0;  ///< of the mesh as it was given
  vec2 uv{0.0};                ///< texture coordinates there; zero where the mesh has none
};

/// Heights over a mesh, to be added by a bake (bake_settings::relief).
struct relief {
  /// Height in metres at right angles to the triangle, outwards positive. Called from several threads at once; finite,
  /// and the same for the same point.
  std::function<double(const relief_point&)> height_m;
  /// Size of the finest detail, m: texels of a map, half of the shortest wavelength. 0: not known.
  double finest_m = 0.0;
  bool reads_uvs = false;  ///< height_m uses relief_point::uv: it fits no mesh without texture coordinates

  [[nodiscard]] explicit operator bool() const noexcept { return static_cast<bool>(height_m); }
};

/// Heights of a relief, weighted with the area of the mesh, metres.
struct relief_extent {
  double lowest_m = 0.0;
  double highest_m = 0.0;
  double mean_m = 0.0;
  double rms_m = 0.0;  ///< about the mean: the roughness Rq where the mesh is flat
};

/// Measures a relief at `samples` points spread evenly over the mesh; always the same ones.
/// @pre the mesh has area; samples > 0
[[nodiscard]] relief_extent measure_relief(const triangle_mesh& mesh, const relief& heights,
                                           std::size_t samples = 65536);

}  // namespace asperity::bake
