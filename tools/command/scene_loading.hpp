// From file names on the command line to a scene.
#pragma once

#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"

namespace asperity::command {

/// Loads the probe and the fixed bodies. Sizes that differ more than 500 times are refused as a mix-up of units unless
/// allowed.
/// @return what load_textured_model says, or invalid_argument
[[nodiscard]] result<scene> load_scene(const std::string& probe, const std::vector<std::string>& fixed,
                                       bool allow_scale_mismatch);

}  // namespace asperity::command
