// What a glTF material says about its surface. Component asperity::io.
#pragma once

#include <filesystem>
#include <functional>

#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"

namespace asperity::io {

/// The normal texture of an asset's material, with what the material and its sampler say of it.
struct normal_texture {
  map_image image;
  double scale = 1.0;
  map_wrap wrap_u = map_wrap::repeat;
  map_wrap wrap_v = map_wrap::repeat;
};

/// The normal texture of the one material that all triangles of a .gltf or .glb have. Images inside the file, in data
/// URIs and in files below its folder are read; the same limits and rules hold as for its buffers.
/// @param keep_going asked at least ten times a second, on this thread; false ends the reading
/// @return io_failed | bad_format | limit_exceeded | cancelled; unsupported where triangles differ in their normal
///         texture or have none, where the texture has a transform or uses other coordinates than TEXCOORD_0
[[nodiscard]] result<normal_texture> load_normal_texture(const std::filesystem::path& file,
                                                         const std::function<bool()>& keep_going = {});

}  // namespace asperity::io
