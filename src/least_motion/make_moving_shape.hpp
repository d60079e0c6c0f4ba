// Lays the finer nodes of a moving shape in a body's notches.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/field/body_field.hpp"
#include "least_motion/kept_relief.hpp"
#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// Makes the bricks of a moving_shape, in three steps: where they may be needed, what moves at their nodes, and their
/// coefficients, in which the smooth part is continued.
class shape_bricks {
 public:
  shape_bricks(const body_field& field, const kept_relief& relief)
      : field_(field), relief_(relief), bricks_along_(moving_shape::bricks_over(field.smooth)) {
    find_notches();
    measure();
  }

  [[nodiscard]] moving_shape make() const {
    std::vector<std::uint32_t> index(measured_.size(), 0);
    std::vector<moving_shape::brick> bricks;
    for_each_place([&](std::size_t x, std::size_t y, std::size_t z) {
      if (!any_about(x, y, z)) return;
      moving_shape::brick nodes;
      if (!add_moving(x, y, z, nodes)) return;
      add_smooth(x, y, z, nodes);
      bricks.push_back(nodes);
      index[place(x, y, z)] = static_cast<std::uint32_t>(bricks.size());
    });
    bricks.shrink_to_fit();
    return {field_.smooth, std::move(index), std::move(bricks)};
  }

 private:
  static constexpr std::size_t cells = moving_shape::cells, finer = moving_shape::finer, along = moving_shape::along;
  static constexpr std::size_t own = cells * finer;  // nodes along a brick that no other brick has
  static constexpr std::size_t with_rim = along + 2;
  using own_nodes = std::array<float, own * own * own>;
  using rim_nodes = std::array<float, with_rim * with_rim * with_rim>;

  template <class Visit>
  void for_each_place(Visit&& visit) const {
    for (std::size_t z = 0; z < bricks_along_[2]; ++z) {
      for (std::size_t y = 0; y < bricks_along_[1]; ++y) {
        for (std::size_t x = 0; x < bricks_along_[0]; ++x) visit(x, y, z);
      }
    }
  }
  [[nodiscard]] std::size_t place(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    return (z * bricks_along_[1] + y) * bricks_along_[0] + x;
  }

  // Marks the bricks with a cell next to a node of S at which some of the relief may move.
  void find_notches() {
    const detail::coarse_grid& grid = field_.smooth;
    measured_.assign(bricks_along_[0] * bricks_along_[1] * bricks_along_[2], 0);
    for (std::size_t k = 0; k < grid.nodes[2]; ++k) {
      for (std::size_t j = 0; j < grid.nodes[1]; ++j) {
        for (std::size_t i = 0; i < grid.nodes[0]; ++i) {
          // The nodes' own values differ from S by a pitch at most.
          const double about_m = std::fabs(static_cast<double>(grid.value[grid.at(i, j, k)]));
          if (about_m > (kept_relief::layer_none + 1.0) * grid.pitch_m) continue;
          if (!kept_relief::may_move(field_.coarse(grid.low + grid.pitch_m * vec3(i, j, k)), grid.pitch_m)) continue;
          const auto first = [](std::size_t n) { return (n < 2 ? 0 : n - 2) / cells; };
          for (std::size_t z = first(k); z <= (k + 1) / cells && z < bricks_along_[2]; ++z) {
            for (std::size_t y = first(j); y <= (j + 1) / cells && y < bricks_along_[1]; ++y) {
              for (std::size_t x = first(i); x <= (i + 1) / cells && x < bricks_along_[0]; ++x) {
                measured_[place(x, y, z)] = 1;
              }
            }
          }
        }
      }
    }
  }

  // Reads the relief that moves, at the nodes of the marked bricks.
  void measure() {
    const detail::coarse_grid& grid = field_.smooth;
    const double pitch_m = grid.pitch_m / static_cast<double>(finer);
    for_each_place([&](std::size_t x, std::size_t y, std::size_t z) {
      std::uint32_t& of = measured_[place(x, y, z)];
      if (of == 0) return;
      own_nodes moves;
      bool any = false;
      std::size_t n = 0;
      for (std::size_t k = 0; k < own; ++k) {
        for (std::size_t j = 0; j < own; ++j) {
          for (std::size_t i = 0; i < own; ++i, ++n) {
            const vec3 p_b = grid.low + pitch_m * vec3(x * own + i, y * own + j, z * own + k);
            moves[n] = static_cast<float>(relief_.moving_m(field_, p_b));
            any = any || moves[n] != 0.0F;
          }
        }
      }
      of = 0;
      if (!any) return;
      moves_.push_back(moves);
      of = static_cast<std::uint32_t>(moves_.size());
    });
  }

  [[nodiscard]] bool any_about(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    const auto from = [](std::size_t n) { return n == 0 ? n : n - 1; };
    for (std::size_t k = from(z); k <= z + 1 && k < bricks_along_[2]; ++k) {
      for (std::size_t j = from(y); j <= y + 1 && j < bricks_along_[1]; ++j) {
        for (std::size_t i = from(x); i <= x + 1 && i < bricks_along_[0]; ++i) {
          if (measured_[place(i, j, k)] != 0) return true;
        }
      }
    }
    return false;
  }

  // Where a node along one axis was measured: in which brick, and which of its own nodes it is.
  struct measured_node {
    std::size_t brick = 0, in = 0;
    bool any = false;  // false: beyond the grid, where nothing moves
  };
  using measured_row = std::array<measured_node, with_rim>;

  // The nodes along an axis of a brick, from two before its first on.
  [[nodiscard]] measured_row row_of(std::size_t axis, std::size_t brick) const noexcept {
    measured_row out;
    for (std::size_t n = 0; n < with_rim; ++n) {
      if (brick * own + n < 2) continue;
      const std::size_t node = brick * own + n - 2;
      out[n] = {node / own, node % own, node / own < bricks_along_[axis]};
    }
    return out;
  }

  // The relief that moves, at the nodes of a brick and its rim. False where none does.
  [[nodiscard]] bool moves_about(std::size_t x, std::size_t y, std::size_t z, rim_nodes& v) const noexcept {
    const measured_row along_x = row_of(0, x), along_y = row_of(1, y), along_z = row_of(2, z);
    bool any = false;
    std::size_t n = 0;
    for (const measured_node& k : along_z) {
      for (const measured_node& j : along_y) {
        for (const measured_node& i : along_x) {
          float& to = v[n++];
          to = 0.0F;
          if (!(k.any && j.any && i.any)) continue;
          const std::uint32_t at = measured_[place(i.brick, j.brick, k.brick)];
          if (at == 0) continue;
          to = moves_[at - 1][(k.in * own + j.in) * own + i.in];
          any = any || to != 0.0F;
        }
      }
    }
    return any;
  }

  // Coefficients for which the spline follows the values up to fourth differences: less a sixth of the second ones
  // along each axis. False where all are zero.
  [[nodiscard]] bool add_moving(std::size_t x, std::size_t y, std::size_t z, moving_shape::brick& out) const {
    rim_nodes v{}, before{};
    if (!moves_about(x, y, z, v)) return false;
    std::size_t stride = 1;
    for (int axis = 0; axis < 3; ++axis, stride *= with_rim) {
      before = v;
      for (std::size_t n = 0; n < v.size(); ++n) {
        const std::size_t i = n / stride % with_rim;
        if (i == 0 || i + 1 == with_rim) continue;
        v[n] -= (before[n - stride] - 2.0F * before[n] + before[n + stride]) / 6.0F;
      }
    }
    bool any = false;
    for (std::size_t k = 0; k < along; ++k) {
      for (std::size_t j = 0; j < along; ++j) {
        for (std::size_t i = 0; i < along; ++i) {
          const float c = v[((k + 1) * with_rim + j + 1) * with_rim + i + 1];
          out[moving_shape::node(i, j, k)] = c;
          any = any || c != 0.0F;
        }
      }
    }
    return any;
  }

  // Adds the coefficients that continue S on the finer nodes.
  void add_smooth(std::size_t x, std::size_t y, std::size_t z, moving_shape::brick& out) const {
    const detail::coarse_grid& grid = field_.smooth;
    const std::array<std::size_t, 3> brick{x, y, z};
    // Nodes of S from one before the brick to one behind it. Beyond the grid none is ever read.
    const auto node = [&](std::size_t axis, std::size_t n) {
      return std::min(std::max<std::size_t>(brick[axis] * cells + n, 1) - 1, grid.nodes[axis] - 1);
    };
    std::array<double, coarse * coarse * coarse> c{};
    for (std::size_t k = 0; k < coarse; ++k) {
      for (std::size_t j = 0; j < coarse; ++j) {
        for (std::size_t i = 0; i < coarse; ++i) {
          c[(k * coarse + j) * coarse + i] =
              static_cast<double>(grid.value[grid.at(node(0, i), node(1, j), node(2, k))]);
        }
      }
    }
    static const std::array<std::array<double, coarse>, along> w = weights();
    for (std::size_t k = 0; k < along; ++k) {
      for (std::size_t j = 0; j < along; ++j) {
        std::array<double, coarse> row{};
        for (std::size_t q = 0; q < coarse; ++q) {
          for (std::size_t p = 0; p < coarse; ++p) {
            const double across = w[k][q] * w[j][p];
            if (across == 0.0) continue;
            for (std::size_t o = 0; o < coarse; ++o) row[o] += across * c[(q * coarse + p) * coarse + o];
          }
        }
        for (std::size_t i = 0; i < along; ++i) {
          double sum = 0.0;
          for (std::size_t o = 0; o < coarse; ++o) sum += w[i][o] * row[o];
          out[moving_shape::node(i, j, k)] += static_cast<float>(sum);
        }
      }
    }
  }

  // What a node of S, from one before a brick on, gives to each of the brick's nodes: a cubic B-spline is a sum of
  // `finer` times narrower ones, whose weights are those of four boxes of that many nodes, one after the other.
  static constexpr std::size_t coarse = cells + 3;
  [[nodiscard]] static std::array<std::array<double, coarse>, along> weights() {
    std::vector<double> mask{static_cast<double>(finer)};
    for (int box = 0; box < 4; ++box) {
      std::vector<double> wider(mask.size() + finer - 1, 0.0);
      for (std::size_t i = 0; i < mask.size(); ++i) {
        for (std::size_t j = 0; j < finer; ++j) wider[i + j] += mask[i] / static_cast<double>(finer);
      }
      mask = std::move(wider);
    }
    std::array<std::array<double, coarse>, along> out{};
    for (std::size_t n = 0; n < along; ++n) {
      for (std::size_t q = 0; q < coarse; ++q) {
        // Both count from the brick's first node, which is the second of each.
        const std::size_t i = n + 3 * (finer - 1), before = q * finer;
        if (i >= before && i - before < mask.size()) out[n][q] = mask[i - before];
      }
    }
    return out;
  }

  const body_field& field_;
  const kept_relief& relief_;
  std::array<std::size_t, 3> bricks_along_;
  std::vector<std::uint32_t> measured_;  // by brick: one more than its place in moves_, 0 where nothing moves
  std::vector<own_nodes> moves_;
};

/// The shape of a body. Allocates; for hundredths of a second a convex body, up to three tenths for one with long
/// notches; not for a tick.
[[nodiscard]] inline moving_shape make_moving_shape(const body_field& field, const kept_relief& relief) {
  return shape_bricks(field, relief).make();
}

}  // namespace asperity::exits
