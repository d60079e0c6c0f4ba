// A mesh as it comes from a file: the full-resolution surface, or a coarse mesh that the user gives.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"

namespace asperity {

/// Indexed triangles in the body frame, metres. Nothing is promised about topology: see bake/check.hpp for that.
struct triangle_mesh {
  std::vector<vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<std::array<vec2, 3>> uvs;                 ///< per corner; empty, or one entry per triangle
};

}  // namespace asperity
