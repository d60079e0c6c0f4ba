// The part of a body that a way out moves: the smooth part of its field, and the relief of notches below it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/coarse_grid.hpp"
#include "asperity/field/cubic_nodes.hpp"

namespace asperity::exits {

/// S' = S + the relief that moves (kept_relief::moving_m()): a cubic B-spline with two continuous derivatives, as S
/// is. In notches, which S fills by up to a third of its pitch, its nodes lie a third of the pitch apart.
///
/// Nodes between those of S continue the same spline exactly (knot insertion), so that S' is S wherever nothing is
/// added, and one reading costs as much as one of S. Made once, beside the field; never changed.
class moving_shape {
 public:
  static constexpr std::size_t cells = 2;                  ///< of S along a brick
  static constexpr std::size_t finer = 3;                  ///< nodes for one of S
  static constexpr std::size_t along = cells * finer + 3;  ///< nodes along a brick, with those that its rim reads
  using brick = std::array<float, along * along * along>;

  /// @param index  per brick one more than its place in bricks, x fastest; 0 where the shape is S
  moving_shape(const detail::coarse_grid& grid, std::vector<std::uint32_t> index, std::vector<brick> bricks)
      : grid_(&grid), bricks_along_(bricks_over(grid)), index_(std::move(index)), bricks_(std::move(bricks)) {}

  /// Bricks over a grid, the last ones half empty.
  [[nodiscard]] static std::array<std::size_t, 3> bricks_over(const detail::coarse_grid& grid) noexcept {
    return {(grid.nodes[0] + cells - 1) / cells, (grid.nodes[1] + cells - 1) / cells,
            (grid.nodes[2] + cells - 1) / cells};
  }
  /// Place in brick of a node.
  [[nodiscard]] static constexpr std::size_t node(std::size_t x, std::size_t y, std::size_t z) noexcept {
    return (z * along + y) * along + x;
  }

  /// The grid of S. Its pitch and what it covers are the shape's too.
  [[nodiscard]] const detail::coarse_grid& grid() const noexcept { return *grid_; }
  [[nodiscard]] const std::array<std::size_t, 3>& bricks_along() const noexcept { return bricks_along_; }
  /// The finer nodes over a brick's place, or null.
  [[nodiscard]] const brick* brick_over(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    const std::uint32_t i = index_[(z * bricks_along_[1] + y) * bricks_along_[0] + x];
    return i == 0 ? nullptr : &bricks_[i - 1];
  }
  /// Whether the nodes about a point are finer than those of S. @rt safe
  [[nodiscard]] bool is_finer(const vec3& p_b) const noexcept {
    const auto cell = grid_->cell_of(grid_->clamped(p_b)).cell;
    return brick_over(cell[0] / cells, cell[1] / cells, cell[2] / cells) != nullptr;
  }

  /// S' and its derivatives. Beyond the grid it goes on as S does. @rt safe: 64 nodes
  [[nodiscard]] coarse_reading read(const vec3& p_b) const noexcept {
    const vec3 c_b = grid_->clamped(p_b);
    coarse_reading out = nodes_at(c_b).read();
    if (c_b != p_b) detail::coarse_grid::go_on_beyond(p_b - c_b, out);
    return out;
  }
  /// S' alone, at a third of the cost. @rt safe
  [[nodiscard]] double value_m(const vec3& p_b) const noexcept {
    const vec3 c_b = grid_->clamped(p_b);
    const double at_c = nodes_at(c_b).value_m();
    return c_b == p_b ? at_c : at_c - glm::length(p_b - c_b);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(index_, bricks_); }

 private:
  [[nodiscard]] detail::cubic_nodes nodes_at(const vec3& clamped_b) const noexcept {
    const detail::coarse_grid::cell_place at = grid_->cell_of(clamped_b);
    const brick* const over = brick_over(at.cell[0] / cells, at.cell[1] / cells, at.cell[2] / cells);
    if (over == nullptr) return grid_->nodes_of(at);
    detail::cubic_nodes out;
    std::size_t first[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const double in_cell = static_cast<double>(finer) * at.f[k];
      const auto between = std::min(static_cast<std::size_t>(std::max(0.0, in_cell)), finer - 1);
      first[k] = at.cell[k] % cells * finer + between;
      out.f[k] = in_cell - static_cast<double>(between);
    }
    out.first = over->data() + node(first[0], first[1], first[2]);
    out.row = along;
    out.layer = along * along;
    out.per_pitch = static_cast<double>(finer) / grid_->pitch_m;
    return out;
  }

  const detail::coarse_grid* grid_;
  std::array<std::size_t, 3> bricks_along_;
  std::vector<std::uint32_t> index_;
  std::vector<brick> bricks_;
};

}  // namespace asperity::exits
