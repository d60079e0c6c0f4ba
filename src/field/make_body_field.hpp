// From a textured model to its depth field. Done once per model, when a renderer is made.
#pragma once

#include "asperity/core/status.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// Says what keeps a field from being made of a model, before it is tried.
/// @return invalid_argument | bad_texture | bad_mesh
[[nodiscard]] result<void> check_field_model(const textured_model& model, const field_settings& settings);

/// Makes the depth field of a model. Takes a fraction of a second, and allocates; not for a tick.
/// @return invalid_argument where a setting is out of range; bad_texture where the model has no texture; bad_mesh where
///         it has no surface, extent or inside; limit_exceeded where the body is too thin for the nodes that it may
///         have
[[nodiscard]] result<body_field> make_body_field(const textured_model& model, const field_settings& settings = {});

}  // namespace asperity
