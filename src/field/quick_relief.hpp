// The relief of a depth field in single precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/core/math.hpp"
#include "asperity/field/relief_bricks.hpp"
#include "field/lanes.hpp"

namespace asperity::detail {

/// Weights of the quadratic B-spline for three nodes in single precision; see quadratic_weights.
struct row_of_three {
  float value[3], slope[3];
  explicit row_of_three(float f) noexcept
      : value{0.5F * (0.5F - f) * (0.5F - f), 0.75F - f * f, 0.5F * (0.5F + f) * (0.5F + f)},
        slope{f - 0.5F, -2.0F * f, f + 0.5F} {}
};

/// relief_bricks::read() at less cost: the three nodes along x lie in one row of four, or in two rows of neighbouring
/// bricks. The value is wrong by less than 1e-6 of the largest coefficient, the slope by that in a pitch.
/// @rt safe: 27 nodes
[[nodiscard]] inline relief_bricks::reading quick_relief(const relief_bricks& of, const vec3& p_b) noexcept {
  constexpr std::size_t side = relief_bricks::side;
  std::array<std::size_t, 3> first{};  // of the three nodes along each axis
  float f[3];
  const double per_pitch = 1.0 / of.pitch_m;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double g = (p_b[axis] - of.low[axis]) * per_pitch + 0.5;
    if (!(g >= 1.0 && g < static_cast<double>(side * of.bricks_along[k]) - 1.0)) return {};
    const auto middle = static_cast<std::size_t>(g);
    f[k] = static_cast<float>(g - 0.5 - static_cast<double>(middle));
    first[k] = middle - 1;
  }
  // Two rows of four, end to end. The weight of a node is the spline at its distance, and zero for five of them.
  struct row_weights {
    lanes value, slope;
  };
  const auto weights_at = [](const lanes& x) noexcept {
    const lanes far = x < 0.0F ? -x : x, outer = 1.5F - far, inner = 0.5F - far;
    const lanes o = outer > 0.0F ? outer : lanes{}, i = inner > 0.0F ? inner : lanes{};
    const lanes falls = o - 3.0F * i;
    return row_weights{0.5F * o * o - 1.5F * i * i, x < 0.0F ? -falls : falls};
  };
  const std::size_t in_row = first[0] % side;
  const lanes off = lanes{0.0F, 1.0F, 2.0F, 3.0F} - (static_cast<float>(in_row + 1) + f[0]);
  const row_weights left = weights_at(off), right = weights_at(off + static_cast<float>(side));
  const bool both = in_row + 3 > side;
  // Of the bricks about the place, two along each axis at most: where a row of nodes along x begins in them.
  struct axis_place {
    std::size_t brick[2], node[3];
    bool beyond[3];
  };
  const auto place_on = [&](std::size_t axis, std::size_t bricks_apart, std::size_t nodes_apart) noexcept {
    axis_place out;
    out.brick[0] = first[axis] / side * bricks_apart;
    out.brick[1] = (first[axis] + 2) / side * bricks_apart;
    for (std::size_t n = 0; n < 3; ++n) {
      out.node[n] = (first[axis] + n) % side * nodes_apart;
      out.beyond[n] = (first[axis] + n) / side != first[axis] / side;
    }
    return out;
  };
  const axis_place y = place_on(1, of.bricks_along[0], side);
  const axis_place z = place_on(2, of.bricks_along[0] * of.bricks_along[1], side * side);
  const std::uint32_t* const index = of.index.data() + first[0] / side;
  const row_of_three along_y(f[1]), along_z(f[2]);
  lanes sum{}, by_x{}, by_y{}, by_z{};
  for (std::size_t k = 0; k < 3; ++k) {
    lanes layer{}, layer_by_x{}, layer_by_y{};
    for (std::size_t j = 0; j < 3; ++j) {
      const std::uint32_t* const bricks = index + z.brick[z.beyond[k] ? 1 : 0] + y.brick[y.beyond[j] ? 1 : 0];
      const std::size_t node = z.node[k] + y.node[j];
      const lanes here = load_lanes(of.bricks[bricks[0]].data() + node);
      lanes row = left.value * here, row_by_x = left.slope * here;
      if (both) {
        const lanes beside = load_lanes(of.bricks[bricks[1]].data() + node);
        row += right.value * beside;
        row_by_x += right.slope * beside;
      }
      layer += along_y.value[j] * row;
      layer_by_x += along_y.value[j] * row_by_x;
      layer_by_y += along_y.slope[j] * row;
    }
    sum += along_z.value[k] * layer;
    by_x += along_z.value[k] * layer_by_x;
    by_y += along_z.value[k] * layer_by_y;
    by_z += along_z.slope[k] * layer;
  }
  const auto total = [](const lanes& of_four) noexcept { return static_cast<double>(sum_of(of_four)); };
  return {total(sum), per_pitch * vec3(total(by_x), total(by_y), total(by_z))};
}

}  // namespace asperity::detail
