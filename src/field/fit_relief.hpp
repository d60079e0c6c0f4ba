// Fits the relief of a depth field to the fine surface.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/field/body_field.hpp"
#include "field/lanes.hpp"
#include "field/relief_points.hpp"
#include "field/relief_stencil.hpp"
#include "field/threads.hpp"

namespace asperity::detail {

/// Least squares over points of the fine surface: at the foot of each, the relief is what the smooth part lacks there.
///
/// A B-spline with samples as coefficients would smooth the texture away; the fit does not. It goes by simultaneous
/// iteration (SIRT: residuals, averaged at the nodes by their weights, correct the coefficients). The first pass
/// averages, and counts each point above and below the surface along its normal, so that the relief does not change
/// across the surface. The others correct what is read at the feet, with Chebyshev's step lengths for wavelengths from
/// three pitches up, and go on where residuals are left: beside sharp edges.
///
/// All passes go brick by brick, over a dense copy of a brick with what lies around it. A thread has a slab of bricks for
/// itself. It goes through the points in their order, those of the bricks beside its slab as well, and adds to its own
/// bricks alone: whatever the slabs, each sum has the same addends in the same order.
/// @source Gilbert, Iterative methods for the three-dimensional reconstruction of an object from projections, 1972
class relief_fit {
 public:
  /// @param points  taken, with their bricks' numbers in out   @param fine_enough_m  residuals that need no further pass
  relief_fit(relief_bricks& out, const relief_points& points, double fine_enough_m, unsigned threads)
      : out_(out), points_(points), fine_enough_(static_cast<float>(fine_enough_m)), threads_(threads) {}

  void solve() {
    lay_slabs();
    const std::size_t count = points_.cells().size();
    work_.assign(count, {});
    residual_.assign(count, 0.0F);
    rows_.assign(count, 0);
    for_each_brick([&](std::size_t b, const slab& own) noexcept { average(b, own); });
    correct(1.0F, true);
    for_each_brick([&](std::size_t b, const slab& own) noexcept { compare(b, true, own); });
    correct(1.816F, false);
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::vector<float> before = std::exchange(residual_, std::vector<float>(count, 0.0F));
      std::atomic<bool> any{false};
      for_each_brick([&](std::size_t b, const slab& own) noexcept {
        if (!unsettled(b, before)) return;
        any.store(true, std::memory_order_relaxed);
        compare(b, false, own);
      });
      if (!any) break;
      constexpr std::array<float, 4> steps{2.669F, 1.251F, 1.026F, 1.816F};
      correct(steps[static_cast<std::size_t>(pass) % 4], false);
    }
    finish();
  }

 private:
  static constexpr std::size_t side = relief_bricks::side, reach = dense_brick::reach, across = dense_brick::across,
                               lanes_across = dense_brick::lanes_across;
  using point = relief_points::point;
  using dense = dense_brick;
  using stencil = relief_stencil;
  static constexpr int most_passes = 2;

  /// Four nodes of a brick along x, stored together because they are read together.
  struct work_row {
    lanes value{}, sum{}, weight{};
  };
  using work_brick = std::array<work_row, side * side>;

  /// The bricks that a thread adds to: from one to before another along the box's longest side.
  struct slab {
    std::size_t begin = 0, end = 0;
  };

  /// Cuts the box of bricks across its longest side into slabs of about as many points.
  void lay_slabs() {
    const auto& along = out_.bricks_along;
    const std::size_t axis = along[0] >= along[1] && along[0] >= along[2] ? 0 : (along[1] >= along[2] ? 1 : 2),
                      layers = along[axis];
    const std::size_t step = axis == 0 ? 1 : (axis == 1 ? along[0] : along[0] * along[1]);
    const std::vector<std::uint32_t>& cells = points_.cells();
    layer_.resize(cells.size());
    std::vector<std::size_t> before(layers + 1, 0);  // points in layers before
    for (std::size_t b = 1; b < cells.size(); ++b) {
      layer_[b] = static_cast<std::uint32_t>(cells[b] / step % layers);
      before[layer_[b] + 1] += points_.of(b).size();
    }
    for (std::size_t l = 0; l < layers; ++l) before[l + 1] += before[l];
    const std::size_t most = threads_ > 1 ? std::size_t{2} * threads_ : 1;
    slabs_.assign(1, {0, layers});
    for (std::size_t i = 1; i < most; ++i) {
      const auto cut = static_cast<std::size_t>(
          std::lower_bound(before.begin(), before.end(), part_begin(before[layers], most, i)) - before.begin());
      // Thinner ones would go through more points of others than of their own.
      constexpr std::size_t thinnest = 4;
      if (cut < slabs_.back().begin + thinnest || cut + thinnest > layers) continue;
      slabs_.back().end = cut;
      slabs_.push_back({cut, layers});
    }
  }

  /// Calls visit(brick, slab) for the bricks with points whose sums reach into a slab, in their order.
  template <class Visit>
  void for_each_brick(const Visit& visit) const {
    for_each_task(slabs_.size(), threads_, [&](std::size_t s) {
      const slab& own = slabs_[s];
      for (std::size_t b = 1; b < points_.cells().size(); ++b) {
        if (layer_[b] + 1 < own.begin || layer_[b] > own.end || points_.of(b).empty()) continue;
        visit(b, own);
      }
    });
  }

  [[nodiscard]] bool owns(const slab& own, std::size_t brick) const noexcept {
    return layer_[brick] >= own.begin && layer_[brick] < own.end;
  }

  /// Calls visit(brick, number) for a brick and the 26 around it; number 0 to 26, x fastest.
  template <class Visit>
  void for_each_beside(std::size_t brick, Visit&& visit) const noexcept {
    const auto [nx, ny, nz] = out_.bricks_along;
    const std::size_t cell = points_.cells()[brick], x = cell % nx, y = cell / nx % ny, z = cell / (nx * ny);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          const bool inside = x + i >= 1 && x + i <= nx && y + j >= 1 && y + j <= ny && z + k >= 1 && z + k <= nz;
          visit(inside ? out_.index[((z + k - 1) * ny + y + j - 1) * nx + x + i - 1] : 0U, (3 * k + j) * 3 + i);
        }
      }
    }
  }

  [[nodiscard]] std::array<std::uint32_t, 27> beside(std::size_t brick) const noexcept {
    std::array<std::uint32_t, 27> out{};
    for_each_beside(brick, [&](std::uint32_t b, std::size_t number) noexcept { out[number] = b; });
    return out;
  }

  /// Calls visit(three bricks, row in each of them, dense row) for rows around a brick, by their bits.
  template <class Visit>
  static void for_each_row(const std::array<std::uint32_t, 27>& around, std::uint64_t rows, Visit&& visit) noexcept {
    for (; rows != 0; rows &= rows - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(rows));
      const std::size_t z = at / across + side - reach, y = at % across + side - reach;
      visit(around.data() + (3 * (z / side) + y / side) * 3, z % side * side + y % side, at * lanes_across);
    }
  }

  /// The bricks around one that are a thread's own; 0 for all others.
  [[nodiscard]] std::array<std::uint32_t, 27> own_of(std::array<std::uint32_t, 27> around,
                                                     const slab& own) const noexcept {
    for (std::uint32_t& b : around) {
      if (!owns(own, b)) b = 0;
    }
    return around;
  }

  void scatter(const dense& from, const std::array<std::uint32_t, 27>& around, std::uint64_t rows,
               lanes work_row::*to) noexcept {
    for_each_row(around, rows, [&](const std::uint32_t* bricks, std::size_t row, std::size_t at) noexcept {
      const lanes &a = from.at[at], &b = from.at[at + 1];
      if (bricks[1] != 0) work_[bricks[1]][row].*to += lanes{a[2], a[3], b[0], b[1]};
      if (bricks[0] != 0 && (a[0] != 0.0F || a[1] != 0.0F)) {
        work_[bricks[0]][row].*to += lanes{0.0F, 0.0F, a[0], a[1]};
      }
      if (bricks[2] != 0 && (b[2] != 0.0F || b[3] != 0.0F)) {
        work_[bricks[2]][row].*to += lanes{b[2], b[3], 0.0F, 0.0F};
      }
    });
  }

  /// Sums of the relief that the points of a brick ask for, above and below the surface.
  void average(std::size_t brick, const slab& own) noexcept {
    dense sum, weight;
    std::uint64_t rows = 0, at_feet = 0;
    for (const point& p : points_.of(brick)) {
      for (const float way : {-1.0F, 1.0F}) {
        const stencil at(p.place + way * p.along);
        at.add(weight, 1.0F);
        at.add(sum, p.relief_m);
        rows |= at.rows();
      }
      at_feet |= stencil(p.place).rows();
    }
    if (owns(own, brick)) rows_[brick] = at_feet;
    const auto around = own_of(beside(brick), own);
    scatter(sum, around, rows, &work_row::sum);
    scatter(weight, around, rows, &work_row::weight);
  }

  /// Sums of the residuals of a brick's points: their relief less what is read at their feet.
  void compare(std::size_t brick, bool weigh, const slab& own) noexcept {
    const auto around = beside(brick);
    dense value, sum, weight;
    for_each_row(around, rows_[brick], [&](const std::uint32_t* bricks, std::size_t row, std::size_t at) noexcept {
      const lanes &low = work_[bricks[0]][row].value, &middle = work_[bricks[1]][row].value;
      value.at[at] = lanes{0.0F, low[3], middle[0], middle[1]};
      value.at[at + 1] = lanes{middle[2], middle[3], work_[bricks[2]][row].value[0], 0.0F};
    });
    float most = 0.0F;
    for (const point& p : points_.of(brick)) {
      const stencil at(p.place);
      const float rest = p.relief_m - at.read(value);
      most = std::max(most, std::fabs(rest));
      at.add(sum, rest);
      if (weigh) at.add(weight, 1.0F);
    }
    if (owns(own, brick)) residual_[brick] = most;
    const auto to = own_of(around, own);
    scatter(sum, to, rows_[brick], &work_row::sum);
    if (weigh) scatter(weight, to, rows_[brick], &work_row::weight);
  }

  /// Whether points of a brick or beside it still have residuals. @param residual by brick
  [[nodiscard]] bool unsettled(std::size_t brick, const std::vector<float>& residual) const noexcept {
    bool out = false;
    for_each_beside(brick, [&](std::uint32_t b, std::size_t) noexcept { out = out || residual[b] > fine_enough_; });
    return out;
  }

  // The first brick stands for all places without one and stays zero.
  void correct(float step, bool forget_weights) {
    for_each_part(work_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        for (work_row& row : work_[b]) {
          row.value += step * row.sum / (row.weight + 1e-30F);  // no weight, no sum
          row.sum = lanes{};
          if (forget_weights) row.weight = lanes{};
        }
      }
    });
  }

  /// Hands the coefficients over. Leaves out bricks whose coefficients are next to zero, on flat faces.
  void finish() {
    const float nothing = 0.01F * fine_enough_;
    std::uint32_t kept = 1;
    std::vector<char> keeps(work_.size());
    for_each_part(work_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        float most = 0.0F;
        for (const work_row& row : work_[b]) {
          for (std::size_t i = 0; i < side; ++i) most = std::max(most, std::fabs(row.value[i]));
        }
        keeps[b] = most > nothing;
      }
    });
    for (std::size_t b = 1; b < work_.size(); ++b) out_.index[points_.cells()[b]] = keeps[b] != 0 ? kept++ : 0;
    out_.bricks.assign(kept, relief_bricks::brick{});
    for_each_part(work_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        if (b == 0 || out_.index[points_.cells()[b]] == 0) continue;
        relief_bricks::brick& to = out_.bricks[out_.index[points_.cells()[b]]];
        for (std::size_t row = 0; row < side * side; ++row) {
          for (std::size_t i = 0; i < side; ++i) {
            // At sharp corners few points determine a coefficient; it is limited because coefficients bound the relief.
            to[row * side + i] =
                std::min(std::max(1.25F * points_.lowest_m(), work_[b][row].value[i]), 1.25F * points_.highest_m());
          }
        }
      }
    });
    work_ = std::vector<work_brick>();
  }

  relief_bricks& out_;
  const relief_points& points_;
  float fine_enough_;
  unsigned threads_;
  std::vector<std::uint32_t> layer_;  // of the bricks, along the box's longest side
  std::vector<slab> slabs_;
  std::vector<work_brick> work_;
  std::vector<std::uint64_t> rows_;  // of each brick's dense copy, that its points' feet reach
  std::vector<float> residual_;      // the largest of each brick's points
};

}  // namespace asperity::detail
