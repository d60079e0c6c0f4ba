// The textured surface as points to draw: one per texel, or as fine as the picture can show.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::picture {

/// Points over one coarse triangle: `rows` + 1 rows of `columns` + 1 points, from its longest edge to the corner
/// opposite, where the last row comes together in one point.
struct fine_patch {
  std::size_t first = 0;  ///< index of its first point
  std::uint32_t columns = 1;
  std::uint32_t rows = 1;
};

struct fine_surface {
  std::vector<fine_patch> patches;  ///< one per coarse triangle
  std::vector<glm::vec3> points;    ///< body frame, m
  std::vector<glm::vec3> normals;   ///< unit, outwards
  std::vector<float> heights;       ///< over the coarse triangle, along its normal, m
  std::vector<float> areas;         ///< of the coarse surface that each point stands for, m^2
};

/// Samples the texture about once per texel, but no closer together than `least_step_m`.
[[nodiscard]] fine_surface sample_fine_surface(const textured_model& model, double least_step_m);

/// Distance of each point to the nearest of the original's surface, m; the same for any number of threads, 0 for all.
/// @return cancelled
[[nodiscard]] result<std::vector<float>> distances(const fine_surface& from, const bake::triangle_bvh& original,
                                                   unsigned threads, bake::stage_monitor& monitor);

/// The value that this share of the area stays below or at. @pre as many values as areas, at least one; 0 <= share <= 1
[[nodiscard]] double quantile(const std::vector<float>& values, const std::vector<float>& areas, double share);

/// Calls visit({i, j, k}) for every small triangle of a patch, points by index, outward side as in the coarse
/// mesh.
template <class Visit>
void for_each_triangle(const fine_patch& patch, const Visit& visit) {
  const std::size_t row = patch.columns + std::size_t{1};
  for (std::uint32_t j = 0; j < patch.rows; ++j) {
    for (std::uint32_t i = 0; i < patch.columns; ++i) {
      const std::size_t at = patch.first + j * row + i;
      visit(std::array<std::size_t, 3>{at, at + 1, at + row});
      if (j + 1 < patch.rows) visit(std::array<std::size_t, 3>{at + 1, at + row + 1, at + row});
    }
  }
}

}  // namespace asperity::picture
