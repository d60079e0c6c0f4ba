// Reading the material of a surface from a file of its own. Component asperity::io.
#pragma once

#include <filesystem>

#include "asperity/core/status.hpp"
#include "asperity/model/material.hpp"

namespace asperity::io {

/// Reads a material: JSON, one object, a physics material of the glTF extension KHR_physics_rigid_bodies with the
/// extension ASPERITY_haptic_material in it, as a textured model holds one. What is left out has the extension's
/// default or ours. See docs/reference/asset-format.md.
/// @return io_failed | bad_format | unsupported | limit_exceeded (above 64 KiB), with the place and the mend
[[nodiscard]] result<material> load_material(const std::filesystem::path& file);

}  // namespace asperity::io
