// Names and numbers of the extension ASPERITY_mesh_haptic_texture, shared by its writer and its reader.
// The format is described in docs/reference/asset-format.md.
#pragma once

#include <cstdint>

namespace asperity::io::extension {

inline constexpr const char* name = "ASPERITY_mesh_haptic_texture";
inline constexpr int version = 1;
inline constexpr const char* units = "m";
inline constexpr int float32_component = 5126;
inline constexpr int uint32_component = 5125;
/// Texel rows start at v = 0 and go up, as glTF orders the rows of an image.
inline constexpr const char* row_order = "v0_first";

/// Numbers per piece in the piece table: vertices, hull faces, covered triangles, flags.
inline constexpr std::size_t table_columns = 4;
inline constexpr std::uint32_t flag_flat = 1;

/// Of the map of materials.
inline constexpr int materials_version = 1;
inline constexpr const char* materials_mime_type = "image/png";

}  // namespace asperity::io::extension
