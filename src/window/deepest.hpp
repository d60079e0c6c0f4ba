// The hard maximum over the window.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "window/height_field.hpp"

namespace asperity::detail {

struct deepest_sample {
  double depth_m = 0.0;        ///< largest h_A - h_B over the samples where both exist (paper, Eq. 9)
  double inner_depth_m = 0.0;  ///< the same without the outermost ring of samples
  double half_width_m = 0.0;   ///< largest |u| or |v| of a sample where both exist, to its cell's border
  std::size_t index = 0;       ///< the deepest sample; of equals the one nearest to the centre
  std::uint32_t samples = 0;   ///< samples where both exist; 0: the other members mean nothing
  std::uint32_t inner_samples = 0;
};

/// @rt safe
[[nodiscard]] inline deepest_sample find_deepest(const height_field& a, const height_field& b,
                                                 const sample_grid& grid) noexcept {
  deepest_sample out;
  double best_radius = 0.0;
  for (std::size_t row = 0, i = 0; row < grid.side; ++row) {
    for (std::size_t column = 0; column < grid.side; ++column, ++i) {
      if (a.kind[i] == hit::none || b.kind[i] == hit::none) continue;
      const double d = a.height[i] - b.height[i];
      const double u = std::fabs(grid.coordinate(column)), v = std::fabs(grid.coordinate(row));
      const double radius = u * u + v * v;
      if (out.samples == 0 || d > out.depth_m || (d == out.depth_m && radius < best_radius)) {
        out.depth_m = d;
        out.index = i;
        best_radius = radius;
      }
      const bool inner = row > 0 && column > 0 && row + 1 < grid.side && column + 1 < grid.side;
      if (inner && (out.inner_samples == 0 || d > out.inner_depth_m)) out.inner_depth_m = d;
      out.inner_samples += inner ? 1 : 0;
      out.half_width_m = std::max(out.half_width_m, std::max(u, v) + 0.5 * grid.pitch_m);
      ++out.samples;
    }
  }
  return out;
}

/// Maximum of the parabola through the deepest sample and its eight neighbours, within half a pitch; the sample's own
/// depth where a neighbour is missing or the fit has no maximum there.
/// @rt safe   @source science, section 7 (sub-sample maximum)
[[nodiscard]] inline double refined_depth(const height_field& a, const height_field& b, const sample_grid& grid,
                                          const deepest_sample& at) noexcept {
  const std::size_t column = at.index % grid.side, row = at.index / grid.side;
  if (column == 0 || row == 0 || column + 1 == grid.side || row + 1 == grid.side) return at.depth_m;
  double d[3][3];
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = grid.index(column + i - 1, row + j - 1);
      if (a.kind[k] == hit::none || b.kind[k] == hit::none) return at.depth_m;
      d[j][i] = a.height[k] - b.height[k];
    }
  }
  const double gu = 0.5 * (d[1][2] - d[1][0]), gv = 0.5 * (d[2][1] - d[0][1]);
  const double huu = d[1][2] - 2.0 * d[1][1] + d[1][0], hvv = d[2][1] - 2.0 * d[1][1] + d[0][1];
  const double huv = 0.25 * (d[2][2] - d[2][0] - d[0][2] + d[0][0]);
  const double det = huu * hvv - huv * huv;
  if (!(huu < 0.0 && det > 0.0)) return at.depth_m;
  const double x = (huv * gv - hvv * gu) / det, y = (huv * gu - huu * gv) / det;
  if (!(std::fabs(x) <= 1.0 && std::fabs(y) <= 1.0)) return at.depth_m;
  return d[1][1] + 0.5 * (gu * x + gv * y);
}

}  // namespace asperity::detail
