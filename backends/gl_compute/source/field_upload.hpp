// The fields and samples of a scene's bodies as the shaders of plane_batch read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/field/field_scene.hpp"

namespace asperity::gl {

/// The contents of the buffers, laid out as plane_layout.hpp says; a body that appears several times lies there once.
struct packed_fields {
  std::vector<float> nodes;
  std::vector<std::int32_t> table;
  std::vector<double> bodies;
  std::size_t most_leaves = 0;  ///< of a meeting
};

/// @return limit_exceeded where an index of a shader would not reach the last number
[[nodiscard]] result<packed_fields> pack_fields(const field_scene& made);

}  // namespace asperity::gl
