// What the field's depth backend reads of a few neighbouring samples.
#pragma once

#include <limits>

#include "asperity/core/math.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// The support plane of the deepest of a few neighbouring samples, and where that sample is.
struct near_plane {
  support_plane plane{.depth_m = -std::numeric_limits<double>::infinity()};  ///< -infinity: there is none
  vec3 point_w{0.0};                                                         ///< the sample, world
};

}  // namespace asperity
