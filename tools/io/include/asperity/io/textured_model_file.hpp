// Reading and writing textured models: .glb with the extension ASPERITY_mesh_haptic_texture. Component asperity::io.
#pragma once

#include <filesystem>
#include <functional>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::io {

/// Loads and checks a textured model; the result meets everything that a tick relies on.
/// @param keep_going asked on the way through the file, on this thread; false ends the reading
/// @return io_failed | bad_format | bad_mesh | bad_texture | unsupported | limit_exceeded | cancelled, with the place
///         and the mend
[[nodiscard]] result<textured_model> load_textured_model(const std::filesystem::path& file,
                                                         const std::function<bool()>& keep_going = {});

/// Writes a valid glTF 2.0 .glb that any viewer opens as the coarse mesh; appears whole or not at all. Positions and
/// texture coordinates are rounded to float32; a model that came from a file is written with the same bits again. The
/// model passes validate() first, so what is written loads again. The layout is in docs/reference/asset-format.md.
/// @return io_failed | bad_mesh | bad_texture | invalid_argument | limit_exceeded
[[nodiscard]] result<void> save_textured_model(const textured_model& model, const std::filesystem::path& file);

/// The model that a file will hold, and that comes back from it: positions and texture coordinates rounded to float32,
/// volume, centre of mass, inertia and box of these, its name as UTF-8. A field that the file should keep is made of
/// this one. @pre it has vertices
[[nodiscard]] textured_model as_saved(textured_model model);

}  // namespace asperity::io
