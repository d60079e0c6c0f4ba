// Reading and writing plain triangle meshes: PLY, OBJ, STL, glTF. Component asperity::io.
#pragma once

#include <filesystem>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::io {

/// Mesh of a .ply (ascii, binary of either byte order), .obj, .stl (ascii, binary), .gltf or .glb file, in the file's
/// own unit and axes. Polygons are split into triangles; vertices at bit-equal positions are welded (STL and UV seams
/// come apart otherwise); vertices that no triangle uses are left out. Texture coordinates follow glTF, v from the
/// image's first row, and are kept where every corner has them (OBJ, glTF). Nothing is said about topology: the bake
/// checks that.
/// @return io_failed | bad_format | unsupported | limit_exceeded, with the file, the line or byte, and the mend
[[nodiscard]] result<triangle_mesh> load_mesh(const std::filesystem::path& file);

/// Writes a binary little-endian PLY; the file appears whole or not at all.
[[nodiscard]] result<void> save_ply(const triangle_mesh& mesh, const std::filesystem::path& file);

}  // namespace asperity::io
