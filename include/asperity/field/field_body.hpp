// One body as planes and least motion see it: its depth field and its samples.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/field/sample_tree.hpp"

namespace asperity {

/// One body. Immutable once made.
struct field_body {
  body_field field;
  /// Those that tell planes.
  sample_tree samples;
  /// Those in the middle of plain faces, which tell none: where one of them touches, a sample around it is as deep. Least
  /// motion counts them, because each of its samples carries a share of the force.
  sample_tree plain{};
  field_body_settings made_with{};  ///< without the threads, on which it does not depend
  std::uint64_t of_model = 0;       ///< tells whether a model is the one that it was made of: is_made_of()

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(field, samples, plain); }
};

/// Makes a body's field and lays out its samples. Allocates; for fractions of a second, not for a tick.
/// @return invalid_argument (a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<field_body> make_field_body(const textured_model& model,
                                                              const field_body_settings& settings = {});

}  // namespace asperity
