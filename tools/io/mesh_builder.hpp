// From what a mesh file says (points, polygons) to a triangle mesh (welded, triangulated).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "reading_watch.hpp"

namespace asperity::io {

/// Which part of a file each triangle belongs to, and what the parts are called.
struct part_list {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_triangle;

  /// Number of the part of this name, a new one where `fresh` or there is none. Throws rejection for too many.
  std::uint32_t number_of(std::string_view name, bool fresh);
};

/// Polygons as they stand in a file. Readers have checked that positions are finite and indices are in range.
struct polygon_soup {
  std::vector<vec3> positions;
  std::vector<std::uint32_t> corners;  ///< indices into positions, polygon after polygon
  std::vector<std::uint32_t> ends;     ///< for each polygon, one past its last corner
  std::vector<vec2> uvs;
  std::vector<std::uint32_t> corner_uvs;  ///< indices into uvs: none, or one per corner
  part_list* parts = nullptr;             ///< filled in where somebody wants to know
  std::uint32_t part = 0;                 ///< of the polygons that come
  std::vector<std::uint32_t> part_of_polygon;

  /// Throws rejection where the mesh has become larger than the limits of load_mesh().
  void end_polygon() {
    ends.push_back(static_cast<std::uint32_t>(corners.size()));
    if (parts != nullptr) part_of_polygon.push_back(part);
    if (corners.size() - 2 * ends.size() > max_mesh_triangles) refuse_triangles();
  }
  /// Throws rejection.
  [[noreturn]] static void refuse_triangles();
};

/// Throws rejection for more vertices, triangles or corners of one polygon than load_mesh() takes. For counts that a
/// file announces, before anything is made of them.
void check_vertex_count(std::uint64_t count);
void check_triangle_count(std::uint64_t count);
void check_corner_count(std::uint64_t count);

/// Welds vertices at bit-equal positions, splits polygons, leaves out vertices that no triangle uses.
/// Quads and concave polygons are split without folding over.
/// @return bad_format where there is no triangle; limit_exceeded for a concave polygon that is too tangled to be split
///         in a time that grows with its corners
[[nodiscard]] result<triangle_mesh> build_mesh(polygon_soup&& soup, const std::filesystem::path& file,
                                               reading_watch& watch);

/// How a mesh is mended whose fault says nothing else.
inline constexpr const char* mesh_mend = "export the mesh again";

/// Largest index or count that fits the soup.
inline constexpr std::uint64_t max_soup_index = 0xfffffffe;

}  // namespace asperity::io
