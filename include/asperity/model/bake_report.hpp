// What a bake measured of its own work; kept with the model.
#pragma once

#include <cstddef>
#include <optional>

#include "asperity/core/math.hpp"

namespace asperity {

/// Distribution of a length over a surface, metres. The percentiles are by area: half of it is within median_m.
struct length_spread {
  double median_m = 0.0;
  double p99_m = 0.0;
  double max_m = 0.0;

  friend bool operator==(const length_spread&, const length_spread&) = default;
};

/// Measures of how good a bake is. Distances in metres, shares from 0 to 1.
struct bake_quality {
  length_spread to_original;       ///< from the textured surface to the original
  length_spread to_textured;       ///< from the original to the textured surface
  double to_original_rms_m = 0.0;  ///< root mean square of the same, by area
  double to_textured_rms_m = 0.0;
  double crack_max_m = 0.0;  ///< largest gap between the two sides of a coarse edge

  double texel_m = 0.0;            ///< edge of a texel on the coarse surface, in the mean where charts are stretched
  double atlas_utilisation = 0.0;  ///< share of the image that coarse triangles cover
  length_spread texel_spacing;     ///< between neighbouring texels on the fine surface; each pair counts the same

  /// Share of the original's area that no texel represents: no point of the textured surface within two texels of it
  /// faces the same way. Most of it is undercuts.
  double lost_share = 0.0;
  double lost_part_share = 0.0;  ///< of the largest connected part of it, as a share of the original's area
  vec3 lost_part_centre{0.0};    ///< mean over that part's area; zero where nothing is lost
  vec3 lost_part_low{0.0};       ///< corners of its box
  vec3 lost_part_high{0.0};

  double surface_to_hull_max_m = 0.0;  ///< deepest that a coarse triangle lies within its convex piece
  double bridged_air_max_m = 0.0;      ///< farthest that a convex piece stands off the coarse mesh, outside of it

  friend bool operator==(const bake_quality&, const bake_quality&) = default;
};

/// What the bake measured. Distances in metres, between the textured surface and the full-resolution original.
struct bake_report {
  double rms_error_m = 0.0;         ///< root mean square over both directions (texture to original and back)
  double max_error_m = 0.0;         ///< largest of either direction
  double peak_to_valley_m = 0.0;    ///< of the relief, along the normals of the coarse mesh
  double max_displacement_m = 0.0;  ///< largest distance between a texel and its coarse surface point
  std::size_t full_triangles = 0;
  std::size_t fallback_texels = 0;  ///< texels projected to the closest point because their ray met no front face
  std::size_t texels = 0;           ///< texels inside a chart
  std::optional<bake_quality> quality = {};  ///< empty in a model from a file that was written before it was measured
};

}  // namespace asperity
