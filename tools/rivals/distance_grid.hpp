// Signed distance to a closed mesh on a dense grid. OpenVDB makes it; what is kept is one array, the quickest to read.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::rivals {

/// Negative inside, metres; right within the band about the surface and no more than `band_m` beyond it.
struct distance_grid {
  std::vector<float> values;  ///< z fastest
  std::array<int, 3> size{};
  vec3 origin{0.0};  ///< of node (0, 0, 0)
  double voxel_m = 1.0;
  float band_m = 0.0F;
};

/// @param band_m  as far from the surface the distances are right, at least eight voxels
[[nodiscard]] distance_grid make_distance_grid(const triangle_mesh& mesh, double voxel_m, double band_m);

}  // namespace asperity::rivals
