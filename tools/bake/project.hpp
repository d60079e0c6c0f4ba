// Fourth stage of the bake: the haptic texture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/bake/texel_filter.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/haptic_texture.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/added_relief.hpp"
#include "bake/atlas.hpp"
#include "bake/crease_normals.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

struct projection {
  haptic_texture texture;
  std::vector<std::uint32_t> chart;  ///< per texel: the chart that it lies in; no_halfedge in gutters and outside
  std::size_t texels = 0;            ///< inside a chart, gutters not counted
  std::size_t fallback_texels = 0;   ///< of these, projected to the closest point
  double highest_m = 0.0;            ///< largest displacement along the direction of projection
  double lowest_m = 0.0;             ///< smallest
  double max_displacement_m = 0.0;   ///< largest distance between a texel and its coarse surface point
};

/// Fills every texel inside a chart with the point where the direction of its coarse surface point, followed both ways,
/// first meets the front of the original within range_m; where it meets none, with the point of the original closest to
/// it. Texels of the gutter continue the chart's own surface: the coarse triangle's plane, plus a displacement of
/// 2 d(edge) - d(mirror), so that a bilinear lookup at the edge of a chart gives the edge. All others are NaN.
/// Where `heights` are given, each point then goes on in its direction until it is that height above the plane of the
/// triangle that it has met.
/// A filter other than `point` takes the average or the highest of the offsets, along that direction, over the texel's
/// footprint; a texel whose own middle has no offset of that kind stays the closest point.
/// @return cancelled | bad_texture (a height that is not finite)
[[nodiscard]] result<projection> project(const triangle_mesh& coarse, const atlas& charts,
                                         const crease_normals& directions, const triangle_bvh& full, double range_m,
                                         std::uint32_t texture_size, unsigned threads, stage_monitor& monitor,
                                         const added_relief* heights = nullptr,
                                         texel_filter filter = texel_filter::point);

}  // namespace asperity::bake
