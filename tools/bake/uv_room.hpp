// Do the triangles of a mesh keep apart in its texture?
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/image_triangle.hpp"

namespace asperity::bake {

struct triangle_pair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  double apart_texels = 0.0;
};

/// Slack for the rounding of texture coordinates, texels: triangles that overlap by less do not.
inline constexpr double uv_slack_texels = 0.002;

/// Work that grows with the triangles' boxes in the image is bounded by this many times its texels.
/// @return limit_exceeded where they are needles that lie across one another's boxes again and again
[[nodiscard]] result<void> check_boxes(std::span<const image_triangle> image, std::uint32_t texture_size);

/// Two triangles that share a part of the image: one texel cannot be two places of the surface.
/// @pre check_boxes
[[nodiscard]] std::optional<triangle_pair> find_overlap(std::span<const image_triangle> image);

/// Of the pairs of triangles that need the same texel in their gutters and are not the same surface there, the two
/// that are nearest in the image. Triangles are the same surface at a texel where they share a vertex and continue to
/// places within a few texels of each other, or where others between them do. So the two sides of a seam may be near,
/// and the inner corner of a chart may be narrow.
/// @pre check_boxes; no overlap
[[nodiscard]] std::optional<triangle_pair> find_crowding(const triangle_mesh& mesh,
                                                         std::span<const image_triangle> image,
                                                         std::uint32_t texture_size);

}  // namespace asperity::bake
