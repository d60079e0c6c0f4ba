// The precision that shaders calculate in. Component asperity::gl_compute.
#pragma once

#include <cstdint>

namespace asperity::gl {

enum class arithmetic : std::uint8_t {
  automatic,         ///< double where shaders have it, single elsewhere (ES)
  single_precision,  ///< quicker on cards for games, at the error that compute_depth and plane_batch state
  double_precision,
};

}  // namespace asperity::gl
