// From what a mesh file says (points, polygons) to a triangle mesh (welded, triangulated).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::io {

/// Polygons as they stand in a file. Readers have checked that positions are finite and indices are in range.
struct polygon_soup {
  std::vector<vec3> positions;
  std::vector<std::uint32_t> corners;  ///< indices into positions, polygon after polygon
  std::vector<std::uint32_t> ends;     ///< for each polygon, one past its last corner
  std::vector<vec2> corner_uvs;        ///< empty, or one per corner

  void end_polygon() { ends.push_back(static_cast<std::uint32_t>(corners.size())); }
};

/// Welds vertices at bit-equal positions, splits polygons, leaves out vertices that no triangle uses.
/// Quads and concave polygons are split without folding over.
/// @return bad_format where there is no triangle; limit_exceeded for a concave polygon of more than 256 corners
[[nodiscard]] result<triangle_mesh> build_mesh(polygon_soup&& soup, const std::filesystem::path& file);

/// Largest index or count that fits the soup.
inline constexpr std::uint64_t max_soup_index = 0xfffffffe;

}  // namespace asperity::io
