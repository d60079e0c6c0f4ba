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
#include "field/threads.hpp"
#include "least_motion/finer_readings.hpp"
#include "least_motion/inserted_nodes.hpp"
#include "least_motion/kept_relief.hpp"
#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// Makes the bricks of a moving_shape, in three steps: where they may be needed, what moves at their nodes, and their
/// coefficients, in which the smooth part is continued.
class shape_bricks {
 public:
  /// @param threads that work at once; what is made does not depend on them
  shape_bricks(const body_field& field, const kept_relief& relief, unsigned threads)
      : field_(field), relief_(relief), threads_(threads), bricks_along_(moving_shape::bricks_over(field.smooth)) {
    find_notches();
    measure();
  }

  [[nodiscard]] moving_shape make() const {
    std::vector<brick_place> about;
    for_each_place([&](const brick_place& at) {
      if (any_about(at)) about.push_back(at);
    });
    std::vector<std::uint32_t> index(measured_.size(), 0);
    std::vector<moving_shape::brick> bricks =
        numbered<moving_shape::brick>(about, index, [&](const brick_place& at, moving_shape::brick& nodes) {
          if (!add_moving(at, nodes)) return false;
          add_smooth(at, nodes);
          return true;
        });
    bricks.shrink_to_fit();
    return {field_.smooth, std::move(index), std::move(bricks)};
  }

 private:
  static constexpr std::size_t cells = moving_shape::cells, finer = moving_shape::finer, along = moving_shape::along;
  static constexpr std::size_t coarse = inserted_nodes::coarse;
  static constexpr std::size_t own = cells * finer;  // nodes along a brick that no other brick has
  static constexpr std::size_t with_rim = along + 2;
  using own_nodes = std::array<float, own * own * own>;
  using rim_nodes = std::array<float, with_rim * with_rim * with_rim>;

  struct brick_place {
    std::size_t x, y, z;
  };

  template <class Visit>
  void for_each_place(Visit&& visit) const {
    for (std::size_t z = 0; z < bricks_along_[2]; ++z) {
      for (std::size_t y = 0; y < bricks_along_[1]; ++y) {
        for (std::size_t x = 0; x < bricks_along_[0]; ++x) visit(brick_place{x, y, z});
      }
    }
  }
  [[nodiscard]] std::size_t place(const brick_place& at) const noexcept {
    return (at.z * bricks_along_[1] + at.y) * bricks_along_[0] + at.x;
  }

  // Makes an item for each of some places where make(place, item) says that there is one. Each place's number in `index`
  // becomes one more than that of its item, or 0.
  template <class Item, class Make>
  [[nodiscard]] std::vector<Item> numbered(const std::vector<brick_place>& at, std::vector<std::uint32_t>& index,
                                           const Make& make) const {
    const std::size_t parts = detail::parts_for(at.size(), threads_);
    std::vector<std::vector<Item>> made(parts);
    detail::for_each_task(parts, threads_, [&](std::size_t part) {
      const std::size_t begin = detail::part_begin(at.size(), parts, part);
      const std::size_t end = detail::part_begin(at.size(), parts, part + 1);
      made[part].reserve(end - begin);
      for (std::size_t i = begin; i < end; ++i) {
        Item item;
        std::uint32_t& number = index[place(at[i])];
        number = 0;
        if (!make(at[i], item)) continue;
        made[part].push_back(item);
        number = static_cast<std::uint32_t>(made[part].size());
      }
    });
    std::uint32_t before = 0;
    for (std::size_t part = 0; part < parts; ++part) {
      for (std::size_t i = detail::part_begin(at.size(), parts, part);
           i < detail::part_begin(at.size(), parts, part + 1); ++i) {
        std::uint32_t& number = index[place(at[i])];
        if (number != 0) number += before;
      }
      before += static_cast<std::uint32_t>(made[part].size());
    }
    return detail::joined(std::move(made));
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
                measured_[place({x, y, z})] = 1;
              }
            }
          }
        }
      }
    }
  }

  // Reads the relief that moves, at the nodes of the marked bricks.
  void measure() {
    std::vector<brick_place> marked;
    for_each_place([&](const brick_place& at) {
      if (measured_[place(at)] != 0) marked.push_back(at);
    });
    moves_ = numbered<own_nodes>(marked, measured_,
                                 [&](const brick_place& at, own_nodes& moves) { return measure(at, moves); });
  }

  // False where nothing moves.
  [[nodiscard]] bool measure(const brick_place& at, own_nodes& moves) const {
    const detail::coarse_grid& grid = field_.smooth;
    const double pitch_m = grid.pitch_m / static_cast<double>(finer);
    const finer_readings near(grid, {at.x * cells, at.y * cells, at.z * cells});
    bool any = false;
    std::size_t n = 0;
    for (std::size_t k = 0; k < own; ++k) {
      for (std::size_t j = 0; j < own; ++j) {
        for (std::size_t i = 0; i < own; ++i, ++n) {
          moves[n] = 0.0F;
          if (!near.may_move(n)) continue;
          const vec3 p_b = grid.low + pitch_m * vec3(at.x * own + i, at.y * own + j, at.z * own + k);
          moves[n] = static_cast<float>(relief_.moving_m(field_, p_b));
          any = any || moves[n] != 0.0F;
        }
      }
    }
    return any;
  }

  [[nodiscard]] bool any_about(const brick_place& at) const noexcept {
    const auto from = [](std::size_t n) { return n == 0 ? n : n - 1; };
    for (std::size_t k = from(at.z); k <= at.z + 1 && k < bricks_along_[2]; ++k) {
      for (std::size_t j = from(at.y); j <= at.y + 1 && j < bricks_along_[1]; ++j) {
        for (std::size_t i = from(at.x); i <= at.x + 1 && i < bricks_along_[0]; ++i) {
          if (measured_[place({i, j, k})] != 0) return true;
        }
      }
    }
    return false;
  }

  // Part of a row of a brick and its rim, which starts two nodes before the brick: those that one brick measured.
  struct row_part {
    std::size_t brick, begin, count, in;  // of them, the first in the row, how many, the first of the brick's own
    bool is_there;                        // false: beyond the grid, where nothing moves
  };
  using row_parts = std::array<row_part, 3>;

  [[nodiscard]] row_parts parts_of(std::size_t axis, std::size_t brick) const noexcept {
    return {{{brick - 1, 0, 2, own - 2, brick > 0},
             {brick, 2, own, 0, true},
             {brick + 1, own + 2, with_rim - own - 2, 0, brick + 1 < bricks_along_[axis]}}};
  }

  // The relief that moves, at the nodes of a brick and its rim, into zeros. False where none does.
  [[nodiscard]] bool moves_about(const brick_place& of, rim_nodes& v) const noexcept {
    const row_parts along_x = parts_of(0, of.x), along_y = parts_of(1, of.y), along_z = parts_of(2, of.z);
    bool any = false;
    for (const row_part& k : along_z) {
      for (const row_part& j : along_y) {
        for (const row_part& i : along_x) {
          if (!(k.is_there && j.is_there && i.is_there)) continue;
          const std::uint32_t number = measured_[place({i.brick, j.brick, k.brick})];
          if (number == 0) continue;
          const own_nodes& from = moves_[number - 1];
          for (std::size_t z = 0; z < k.count; ++z) {
            for (std::size_t y = 0; y < j.count; ++y) {
              const float* const row = from.data() + ((k.in + z) * own + j.in + y) * own + i.in;
              float* const to = v.data() + ((k.begin + z) * with_rim + j.begin + y) * with_rim + i.begin;
              for (std::size_t x = 0; x < i.count; ++x) {
                to[x] = row[x];
                any = any || row[x] != 0.0F;
              }
            }
          }
        }
      }
    }
    return any;
  }

  // Less a sixth of the second differences of neighbours that lie `stride` apart, from node begin to node end.
  static void sharpen(const float* before, std::size_t stride, std::size_t begin, std::size_t end, float* v) noexcept {
    for (std::size_t n = begin; n < end; ++n) {
      v[n] -= (before[n - stride] - 2.0F * before[n] + before[n + stride]) / 6.0F;
    }
  }

  // Coefficients for which the spline follows the values up to fourth differences: less a sixth of the second ones
  // along each axis. False where all are zero.
  [[nodiscard]] bool add_moving(const brick_place& at, moving_shape::brick& out) const {
    constexpr std::size_t row = with_rim, layer = with_rim * with_rim, all = with_rim * with_rim * with_rim;
    rim_nodes v{};
    if (!moves_about(at, v)) return false;
    rim_nodes before = v;
    for (std::size_t n = 0; n < all; n += row) sharpen(before.data(), 1, n + 1, n + row - 1, v.data());
    before = v;
    for (std::size_t n = 0; n < all; n += layer) sharpen(before.data(), row, n + row, n + layer - row, v.data());
    before = v;
    sharpen(before.data(), layer, layer, all - layer, v.data());
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
  void add_smooth(const brick_place& at, moving_shape::brick& out) const {
    const detail::coarse_grid& grid = field_.smooth;
    const std::array<std::size_t, 3> brick{at.x, at.y, at.z};
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
    static const inserted_nodes w;
    for (std::size_t k = 0; k < along; ++k) {
      for (std::size_t j = 0; j < along; ++j) {
        std::array<double, coarse> row{};
        for (std::size_t q = w.first[k]; q < w.end[k]; ++q) {
          for (std::size_t p = w.first[j]; p < w.end[j]; ++p) {
            const double across = w.of[q][k] * w.of[p][j];
            for (std::size_t o = 0; o < coarse; ++o) row[o] += across * c[(q * coarse + p) * coarse + o];
          }
        }
        std::array<double, along> sum{};
        for (std::size_t o = 0; o < coarse; ++o) {
          for (std::size_t i = 0; i < along; ++i) sum[i] += w.of[o][i] * row[o];
        }
        for (std::size_t i = 0; i < along; ++i) out[moving_shape::node(i, j, k)] += static_cast<float>(sum[i]);
      }
    }
  }

  const body_field& field_;
  const kept_relief& relief_;
  unsigned threads_;
  std::array<std::size_t, 3> bricks_along_;
  std::vector<std::uint32_t> measured_;  // by brick: one more than its place in moves_, 0 where nothing moves
  std::vector<own_nodes> moves_;
};

/// The shape of a body, the same for any number of threads. Allocates; for hundredths of a second a convex body, up to
/// two tenths for one with long notches; not for a tick.
[[nodiscard]] inline moving_shape make_moving_shape(const body_field& field, const kept_relief& relief,
                                                    unsigned threads) {
  return shape_bricks(field, relief, threads).make();
}

}  // namespace asperity::exits
