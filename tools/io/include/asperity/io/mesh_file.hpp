// Reading and writing plain triangle meshes: PLY, OBJ, STL, glTF. Component asperity::io.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::io {

/// Limits of a mesh in a file: triangles (as many as a bake takes), vertices before equal ones are welded (those of an
/// STL are its triangles'), corners of one polygon.
inline constexpr std::size_t max_mesh_triangles = 8'000'000;
inline constexpr std::size_t max_mesh_vertices = 16'000'000;
inline constexpr std::size_t max_polygon_corners = 65'536;

/// Mesh of a .ply (ascii, binary of either byte order), .obj, .stl (ascii, binary), .gltf or .glb file, in the file's
/// own unit and axes. Polygons are split into triangles; vertices at bit-equal positions are welded (STL and UV seams
/// come apart otherwise); vertices that no triangle uses are left out. Texture coordinates follow glTF, v from the
/// image's first row, and are kept where every corner has them (OBJ, glTF). Nothing is said about topology: the bake
/// checks that.
/// Takes time in proportion to the file, and memory for four times the file and 512 MiB at the most.
/// @param keep_going asked at least ten times a second, on this thread; false ends the reading
/// @return io_failed | bad_format | unsupported | limit_exceeded | cancelled, with the file, the line or byte, and the
///         mend
[[nodiscard]] result<triangle_mesh> load_mesh(const std::filesystem::path& file,
                                              const std::function<bool()>& keep_going = {});

/// A mesh that is a part of a file's, with its name there.
struct mesh_part {
  std::string name;  ///< may be empty, and several may have the same
  triangle_mesh mesh;
};
inline constexpr std::size_t max_mesh_parts = 1000;

/// The same mesh in parts: the groups and objects of an OBJ, the nodes of a glTF scene. Where a file names fewer than two,
/// its surfaces that share no vertex, one that lies within the box of a larger one together with that. In the order of
/// their first triangles; parts without triangles are left out.
/// @return as load_mesh(); limit_exceeded for more than max_mesh_parts
[[nodiscard]] result<std::vector<mesh_part>> load_mesh_parts(const std::filesystem::path& file,
                                                             const std::function<bool()>& keep_going = {});

/// Writes a binary little-endian PLY; the file appears whole or not at all.
[[nodiscard]] result<void> save_ply(const triangle_mesh& mesh, const std::filesystem::path& file);

}  // namespace asperity::io
