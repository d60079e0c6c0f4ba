// How far a textured surface leaves its coarse triangles: what a depth can be at most, before anything is drawn.
#pragma once

#include <vector>

#include "asperity/model/textured_model.hpp"
#include "model/surface_index.hpp"

namespace asperity::gl {

/// Box of (fine point - coarse point) over a coarse triangle, body frame, m.
struct displacement_box {
  vec3 low{0.0}, high{0.0};
};

/// A box per coarse triangle, over every texel that a lookup inside of it can touch.
[[nodiscard]] std::vector<displacement_box> displacement_bounds(const textured_model& model,
                                                                const detail::surface_index& index);

}  // namespace asperity::gl
