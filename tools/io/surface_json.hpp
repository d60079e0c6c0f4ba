// A surface's material as JSON: a physics material of KHR_physics_rigid_bodies, and our extension in it.
// The format is described in docs/reference/asset-format.md.
#pragma once

#include <tiny_gltf.h>

#include "asperity/model/material.hpp"
#include "json_fields.hpp"

namespace asperity::io {

namespace extension {

inline constexpr const char* rigid_bodies = "KHR_physics_rigid_bodies";
inline constexpr const char* haptic_material = "ASPERITY_haptic_material";
inline constexpr int haptic_material_version = 1;

}  // namespace extension

/// A physics material. Throws rejection where a number is none, out of range, or of another version.
[[nodiscard]] material read_material(const json_object& from);

/// The same as it is written. @pre check(m); the name is UTF-8
[[nodiscard]] tinygltf::Value::Object material_object(const material& m);

}  // namespace asperity::io
