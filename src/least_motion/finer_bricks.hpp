// What bounds the finer nodes of a moving shape, cell by cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/field/coarse_grid.hpp"
#include "field/threads.hpp"
#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// Square of a bound of the second derivatives at a node, per square of the distance of nodes.
[[nodiscard]] inline double squared_difference(const float* at, const std::size_t (&stride)[3]) noexcept {
  const auto value = [at](std::ptrdiff_t n) { return static_cast<double>(at[n]); };
  double squares = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto d = static_cast<std::ptrdiff_t>(stride[a]);
    const double bend = value(d) - 2.0 * value(0) + value(-d);
    squares += bend * bend;
    for (std::size_t b = a + 1; b < 3; ++b) {
      const auto e = static_cast<std::ptrdiff_t>(stride[b]);
      double most = 0.0;
      for (const std::ptrdiff_t n : {std::ptrdiff_t{0}, -d, -e, -d - e}) {
        most = std::max(most, std::fabs(value(n + d + e) - value(n + d) - value(n + e) + value(n)));
      }
      squares += 2.0 * most * most;
    }
  }
  return squares;
}

/// The slope in the middle of a cell, from its eight corners, per distance of nodes: sharper than the spline's, which
/// averages such slopes.
[[nodiscard]] inline vec3 middle_slope(const float* at, const std::size_t (&stride)[3]) noexcept {
  vec3 out(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t d = stride[axis], e = stride[(axis + 1) % 3], f = stride[(axis + 2) % 3];
    double rise = 0.0;
    for (const std::size_t n : {std::size_t{0}, e, f, e + f}) {
      rise += static_cast<double>(at[n + d]) - static_cast<double>(at[n]);
    }
    out[static_cast<int>(axis)] = 0.25 * rise;
  }
  return out;
}

/// Bounds of the cells of S in a brick with finer nodes. Next to a cell's rim the spline also reads nodes that count for
/// its neighbours: there the largest of both is the bound, as field_bounds takes it.
struct finer_brick {
  struct cell {
    float highest_m = 0.0F, bend_per_m = 0.0F;
  };
  static constexpr std::size_t side = moving_shape::cells;

  std::array<std::size_t, 3> place{};
  std::array<cell, side * side * side> cells{};  ///< x fastest
  double steepest_squared = 0.0;                 ///< in the middle of a cell of the finer nodes, per their distance

  /// Its cell's first node of S.
  [[nodiscard]] std::array<std::size_t, 3> node_of(std::size_t c) const noexcept {
    return {place[0] * side + c % side, place[1] * side + c / side % side, place[2] * side + c / (side * side)};
  }
  /// Whether a cell of the grid begins there: a brick at the grid's far side may be half beyond it.
  [[nodiscard]] static bool is_cell(const detail::coarse_grid& grid, const std::array<std::size_t, 3>& node) noexcept {
    return node[0] + 1 < grid.nodes[0] && node[1] + 1 < grid.nodes[1] && node[2] + 1 < grid.nodes[2];
  }

  /// Measures them. The spline in a cell reads `finer` + 3 nodes along each axis; neighbouring cells share some of
  /// these, and each is measured once.
  void measure(const moving_shape::brick& nodes, const detail::coarse_grid& grid) noexcept {
    constexpr std::size_t finer = moving_shape::finer, along = moving_shape::along, reads = finer + 3;
    constexpr std::size_t stride[3] = {1, along, along * along};
    std::array<double, along * along * along> bend{}, slope{};  // squares; at inner nodes, and in cells
    for (std::size_t k = 0; k + 1 < along; ++k) {
      for (std::size_t j = 0; j + 1 < along; ++j) {
        const std::size_t row = moving_shape::node(0, j, k);
        for (std::size_t n = row; n + 1 < row + along; ++n) {
          const vec3 middle = middle_slope(nodes.data() + n, stride);
          slope[n] = glm::dot(middle, middle);
        }
        if (k == 0 || j == 0) continue;
        for (std::size_t n = row + 1; n + 1 < row + along; ++n) bend[n] = squared_difference(nodes.data() + n, stride);
      }
    }
    const double per_pitch = static_cast<double>(finer) / grid.pitch_m;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::size_t first =
          moving_shape::node(c % side * finer, c / side % side * finer, c / (side * side) * finer);
      const bool counts = is_cell(grid, node_of(c));
      float highest_m = nodes[first];
      double most_bend = 0.0;
      for (std::size_t k = 0; k < reads; ++k) {
        for (std::size_t j = 0; j < reads; ++j) {
          const std::size_t row = first + moving_shape::node(0, j, k);
          for (std::size_t n = row; n < row + reads; ++n) highest_m = std::max(highest_m, nodes[n]);
          if (counts && k + 1 < reads && j + 1 < reads) {
            for (std::size_t n = row; n + 1 < row + reads; ++n) steepest_squared = std::max(steepest_squared, slope[n]);
          }
          if (k == 0 || j == 0 || k + 1 == reads || j + 1 == reads) continue;
          for (std::size_t n = row + 1; n + 1 < row + reads; ++n) most_bend = std::max(most_bend, bend[n]);
        }
      }
      cells[c] = {highest_m, static_cast<float>(1.0001 * per_pitch * per_pitch * std::sqrt(most_bend))};
    }
  }
};

/// Bounds of all bricks of a shape with finer nodes. Allocates.
/// @param threads that work at once; the result does not depend on them
[[nodiscard]] inline std::vector<finer_brick> measured_bricks(const moving_shape& shape, unsigned threads) {
  const auto& bricks = shape.bricks_along();
  std::vector<finer_brick> out;
  for (std::size_t z = 0; z < bricks[2]; ++z) {
    for (std::size_t y = 0; y < bricks[1]; ++y) {
      for (std::size_t x = 0; x < bricks[0]; ++x) {
        if (shape.brick_over(x, y, z) != nullptr) out.emplace_back().place = {x, y, z};
      }
    }
  }
  detail::for_each_part(out.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& at = out[i].place;
      out[i].measure(*shape.brick_over(at[0], at[1], at[2]), shape.grid());
    }
  });
  return out;
}

}  // namespace asperity::exits
