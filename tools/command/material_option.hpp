// --material: a preset or a file.
#pragma once

#include <string>

#include "asperity/core/status.hpp"
#include "asperity/model/material.hpp"
#include "cli.hpp"

namespace asperity::command {

/// The preset of this name, or the material of this file. A file that is named like a preset needs its folder: ./steel.
/// @return invalid_argument where it is neither; what io::load_material() says of a file
[[nodiscard]] result<material> read_material_option(const std::string& name_or_file);

[[nodiscard]] json to_json(const material& m);
[[nodiscard]] json to_json(const surface_pair& pair);
[[nodiscard]] std::string to_text(const material& m);
[[nodiscard]] std::string to_text(const surface_pair& pair);

}  // namespace asperity::command
