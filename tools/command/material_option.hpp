// --material and --material-at: presets and files.
#pragma once

#include <string>

#include "asperity/bake/map_materials.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/material.hpp"
#include "asperity/model/textured_model.hpp"
#include "cli.hpp"

namespace asperity::command {

/// The preset of this name, or the material of this file. A file that is named like a preset needs its folder: ./steel.
/// @return invalid_argument where it is neither; what io::load_material() says of a file
[[nodiscard]] result<material> read_material_option(const std::string& name_or_file,
                                                    const std::string& option = "--material");

/// One --material-at: COLOUR=NAME|FILE, where COLOUR is #rrggbb, rrggbb or a grey level from 0 to 255.
/// @return invalid_argument; what read_material_option() says
[[nodiscard]] result<bake::material_colour> read_material_at(const std::string& text);
/// The file that a --material-at names; empty where it names a preset.
[[nodiscard]] std::string file_of_material_at(const std::string& text);

/// With the model's map: what is of which material, and their shares of the surface. Of one without: the material.
[[nodiscard]] json materials_json(const textured_model& model);

[[nodiscard]] json to_json(const material& m);
[[nodiscard]] json to_json(const surface_pair& pair);
[[nodiscard]] std::string to_text(const material& m);
[[nodiscard]] std::string to_text(const surface_pair& pair);

}  // namespace asperity::command
