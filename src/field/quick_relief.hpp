// The relief of a depth field in single precision, its value alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/core/math.hpp"
#include "asperity/field/relief_bricks.hpp"
#include "field/lanes.hpp"

namespace asperity::detail {

/// relief_bricks::read(), its value alone, at less cost: the three nodes along x lie in one row of four, or in
/// two rows of neighbouring bricks. Wrong by less than 1e-6 of the largest coefficient.
/// @rt safe: 27 nodes
[[nodiscard]] inline double quick_relief(const relief_bricks& of, const vec3& p_b) noexcept {
  constexpr std::size_t side = relief_bricks::side;
  std::array<std::size_t, 3> first{};  // of the three nodes along each axis
  float f[3];
  const double per_pitch = 1.0 / of.pitch_m;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double g = (p_b[axis] - of.low[axis]) * per_pitch + 0.5;
    if (!(g >= 1.0 && g < static_cast<double>(side * of.bricks_along[k]) - 1.0)) return 0.0;
    const auto middle = static_cast<std::size_t>(g);
    f[k] = static_cast<float>(g - 0.5 - static_cast<double>(middle));
    first[k] = middle - 1;
  }
  const auto weights = [](float at) noexcept {
    return std::array<float, 3>{0.5F * (0.5F - at) * (0.5F - at), 0.75F - at * at, 0.5F * (0.5F + at) * (0.5F + at)};
  };
  const std::array<float, 3> along_y = weights(f[1]), along_z = weights(f[2]);
  // Two rows of four, end to end. The weight of a node is the spline at its distance, and zero for five of them.
  const std::size_t in_row = first[0] % side;
  const auto spline = [](const lanes& x) noexcept {
    const lanes far = x < 0.0F ? -x : x, outer = 1.5F - far, inner = 0.5F - far;
    const lanes o = outer > 0.0F ? outer : lanes{}, i = inner > 0.0F ? inner : lanes{};
    return 0.5F * o * o - 1.5F * i * i;
  };
  const lanes off = lanes{0.0F, 1.0F, 2.0F, 3.0F} - (static_cast<float>(in_row + 1) + f[0]);
  const lanes left = spline(off), right = spline(off + static_cast<float>(side));
  const bool both = in_row + 3 > side;
  const std::size_t brick_x = first[0] / side;
  lanes sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t z = first[2] + k;
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t y = first[1] + j;
      const std::uint32_t* const index =
          of.index.data() + ((z / side) * of.bricks_along[1] + y / side) * of.bricks_along[0] + brick_x;
      const std::size_t node = ((z % side) * side + y % side) * side;
      const float weight = along_y[j] * along_z[k];
      sum += (weight * left) * load_lanes(of.bricks[index[0]].data() + node);
      if (both) sum += (weight * right) * load_lanes(of.bricks[index[1]].data() + node);
    }
  }
  return static_cast<double>(sum_of(sum));
}

}  // namespace asperity::detail
