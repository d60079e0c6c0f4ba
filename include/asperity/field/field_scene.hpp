// The bodies of a scene as the field formulation sees them: a depth field to be measured in, samples to measure with.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/field_settings.hpp"
#include "asperity/field/sample_tree.hpp"
#include "asperity/model/scene.hpp"

namespace asperity {

/// One body. Immutable once made.
struct field_body {
  body_field field;
  sample_tree samples;

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(field, samples); }
};

/// Shared and never changed, like the model it was made of.
using field_body_ptr = std::shared_ptr<const field_body>;

/// Makes a body's field and lays out its samples. Allocates; for fractions of a second, not for a tick.
/// @return invalid_argument (a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<field_body> make_field_body(const textured_model& model,
                                                              const field_body_settings& settings = {});

/// One per body, in the order of the scene.
struct field_scene {
  field_body_ptr probe;
  std::vector<field_body_ptr> fixed;

  [[nodiscard]] ASPERITY_API std::size_t heap_bytes() const noexcept;
};

/// Makes the field and the samples of every body of a scene; a model that appears several times is made once.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<field_scene> make_field_scene(const scene& bodies,
                                                                const field_body_settings& settings = {});

}  // namespace asperity
