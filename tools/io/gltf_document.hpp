// A glTF document whose geometry can be read without looking over one's shoulder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <tiny_gltf.h>
#include <vector>

#include "asperity/core/math.hpp"
#include "gltf_guard.hpp"

namespace asperity::io {

/// Where the bytes of a document's buffers may come from.
enum class buffer_policy : std::uint8_t {
  own_chunk_only,  ///< the BIN chunk of a .glb
  own_folder,      ///< also data URIs and files in the document's folder
};

/// Structure by tinygltf, bytes by ourselves, all of it behind the guard: every index and range in `geometry` is good.
class gltf_document {
 public:
  /// Opens a .glb, or a .gltf where the bytes do not begin like a .glb. Throws rejection.
  /// @pre `bytes` and `watch` outlive the document
  gltf_document(std::string_view bytes, const std::filesystem::path& file, buffer_policy policy, reading_watch& watch);

  /// Meshes, nodes and scenes.
  [[nodiscard]] const tinygltf::Model& geometry() const noexcept { return geometry_; }
  /// The whole JSON as it stands in the file; only its syntax has been checked.
  [[nodiscard]] const json& source() const noexcept { return source_; }

  /// Bytes of a buffer view. @pre view < geometry().bufferViews.size()
  [[nodiscard]] std::string_view view_bytes(std::size_t view) const;
  /// Bytes that a URI gives: its own, where it is a data URI, or those of a file below the folder of `file`, by the
  /// rules for buffers. Throws rejection. @param place names the URI in messages
  [[nodiscard]] static std::string outside_bytes(const std::string& uri, const std::string& place,
                                                 const std::filesystem::path& file, std::uintmax_t limit,
                                                 reading_watch& watch);
  /// Elements of an accessor. Whoever reads several that belong together compares their counts first: an accessor of
  /// bytes takes many times its own size once it is read.
  [[nodiscard]] std::size_t count(int accessor) const {
    return geometry_.accessors[static_cast<std::size_t>(accessor)].count;
  }
  /// POSITION. Throws rejection where the accessor is of another type or a coordinate is not finite.
  [[nodiscard]] std::vector<vec3> positions(int accessor) const;
  /// TEXCOORD_0, float32 or normalised integers. Throws rejection.
  [[nodiscard]] std::vector<vec2> uvs(int accessor) const;
  /// Vertex indices, each below vertex_count; 0, 1, 2, ... for accessor -1. Throws rejection.
  [[nodiscard]] std::vector<std::uint32_t> indices(int accessor, std::size_t vertex_count) const;

 private:
  void collect_buffers(std::string_view bin, const std::filesystem::path& file, buffer_policy policy);
  [[nodiscard]] std::string outside_buffer(const std::string& uri, const std::string& place,
                                           const std::filesystem::path& file);
  [[nodiscard]] const char* element(const tinygltf::Accessor& a, std::size_t i) const;

  reading_watch& watch_;
  json source_;
  tinygltf::Model geometry_;
  std::vector<std::string> owned_;  // buffers that are not the BIN chunk
  std::set<std::filesystem::path> opened_;
  std::vector<std::string_view> buffers_;
};

}  // namespace asperity::io
