// Stands in front of tinygltf and lets through only what has been checked. tinygltf 2.7 reads past buffers, recurses
// without bound, opens files that a URI names and never looks at accessors; a hostile file must not reach that code.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "json_fields.hpp"

namespace asperity::io {

/// Sizes beyond which JSON is refused before anything recursive sees it.
struct json_limits {
  std::size_t bytes = std::size_t{16} << 20;
  std::size_t items = 200'000;
  int depth = 32;
};

/// The two chunks of a .glb.
struct glb_chunks {
  std::string_view json;
  std::string_view bin;
};

/// Splits a .glb; every length must agree with the file's. Throws rejection.
[[nodiscard]] glb_chunks split_glb(std::string_view bytes);

/// Parses JSON whose depth and number of items are within the limits, and in which no object has a name twice: of two
/// values under one name, every reader believes another. Throws rejection.
[[nodiscard]] json parse_bounded(std::string_view text, const json_limits& limits, reading_watch& watch);

/// Copy of a document that holds its geometry and nothing else: buffer views, the accessors that meshes use, meshes,
/// nodes and scenes, each field checked, every index and byte range inside its bounds. Images, extensions and extras
/// are left out, so that no parser ever reads them. Throws rejection.
/// @param buffer_bytes length of each buffer
[[nodiscard]] json checked_geometry(const json& document, const std::vector<std::size_t>& buffer_bytes);

}  // namespace asperity::io
