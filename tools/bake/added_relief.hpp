// A relief that is added to the mesh being baked: its heights over the original, and what is checked of them.
#pragma once

#include <cstdint>
#include <string>

#include "asperity/bake/relief.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// A relief over the original, and the original itself.
struct added_relief {
  const relief& heights;
  const triangle_mesh& original;  ///< checked; its texture coordinates are those that the relief reads

  /// Height over the point of triangle t that is nearest to p. @pre there is a relief
  [[nodiscard]] double at(std::uint32_t t, const vec3& p) const;
};

/// Refuses heights that cannot be meant, before any work is done on them.
/// @return bad_texture (not finite, or a shape rather than a relief) | bad_mesh (no texture coordinates to read)
[[nodiscard]] result<void> check_relief(const added_relief& added, double diagonal_m);

/// The sentence that says that texels are too coarse for the relief; empty where they are not.
[[nodiscard]] std::string too_coarse_remark(const relief& heights, double texel_m, std::uint32_t texture_size);

/// The original with its relief as triangles, about one per texel. Each of its triangles is raised along its own
/// normal.
[[nodiscard]] triangle_mesh raise(const added_relief& added, double texel_m, stage_monitor& monitor);

}  // namespace asperity::bake
