// One reader per format. Each gets the file's bytes, its name for messages, and whom to ask whether to go on.
#pragma once

#include <filesystem>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "reading_watch.hpp"

namespace asperity::io {

struct part_list;

[[nodiscard]] result<triangle_mesh> read_ply(std::string_view bytes, const std::filesystem::path& file,
                                             reading_watch watch = {});
[[nodiscard]] result<triangle_mesh> read_obj(std::string_view bytes, const std::filesystem::path& file,
                                             reading_watch watch = {}, part_list* parts = nullptr);
[[nodiscard]] result<triangle_mesh> read_stl(std::string_view bytes, const std::filesystem::path& file,
                                             reading_watch watch = {});
/// .glb and .gltf; buffers of the latter are read from the file's own folder only.
[[nodiscard]] result<triangle_mesh> read_gltf(std::string_view bytes, const std::filesystem::path& file,
                                              reading_watch watch = {}, part_list* parts = nullptr);
/// A .glb with the extension; the model has passed validate().
[[nodiscard]] result<textured_model> read_textured_model(std::string_view bytes, const std::filesystem::path& file,
                                                         reading_watch watch = {});

}  // namespace asperity::io
