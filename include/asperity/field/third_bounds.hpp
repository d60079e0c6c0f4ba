// Upper bounds of the third derivatives of a body's smooth distance near a point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/coarse_grid.hpp"

namespace asperity::detail {

/// The largest third derivative of a spline about blocks of 2, 4, 8 and 16 cells a side: how far off its second-order
/// expansion at a point can be next to it. A cubic B-spline's third derivatives are averages of its coefficients'
/// third differences, so the largest of these bounds them. Made once, beside the grid; never changed.
class third_bounds {
 public:
  third_bounds() = default;

  /// Allocates a number per seven nodes, and three while it is made.
  explicit third_bounds(const coarse_grid& of) : low_(of.low), pitch_m_(of.pitch_m) {
    level& least = levels_[0];
    for (std::size_t k = 0; k < 3; ++k) least.along[k] = (of.nodes[k] + 1) / 2;
    least.most_per_m2.assign(least.along[0] * least.along[1] * least.along[2], 0.0F);
    constexpr std::size_t x = 0, y = 1, z = 2;
    std::vector<float> work(least.most_per_m2.size());
    for (const std::size_t a : {x, y, z}) {
      add_squares(of, {a, a, a}, 1.0F, work);
      for (const std::size_t b : {x, y, z}) {
        if (a != b) add_squares(of, {a, a, b}, 3.0F, work);
      }
    }
    add_squares(of, {x, y, z}, 6.0F, work);
    const double per_cube = 1.0 / (pitch_m_ * pitch_m_ * pitch_m_);
    for (float& m : least.most_per_m2) m = static_cast<float>(1.0001 * per_cube * std::sqrt(static_cast<double>(m)));
    for (std::size_t l = 1; l < levels_.size(); ++l) levels_[l] = coarser(levels_[l - 1]);
  }

  /// No third derivative within radius_m of a point is larger (Frobenius norm), 1/m^2. Infinity where the radius is
  /// more than eight pitches, and where the point is outside the grid.
  /// @pre the ball is inside the grid's clamped() region   @rt safe: one number
  [[nodiscard]] double most_per_m2(const vec3& p_b, double radius_m) const noexcept {
    constexpr double unknown = std::numeric_limits<double>::infinity();
    std::size_t l = 0;
    double holds_m = pitch_m_, block = 2.0;  // in cells
    for (; l < levels_.size() && radius_m > holds_m; ++l) {
      holds_m *= 2.0;
      block *= 2.0;
    }
    if (l == levels_.size()) return unknown;
    const level& at = levels_[l];
    std::size_t place[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const double g = (p_b[static_cast<int>(k)] - low_[static_cast<int>(k)]) / (block * pitch_m_);
      if (!(g >= 0.0 && g < static_cast<double>(at.along[k]))) return unknown;
      place[k] = static_cast<std::size_t>(g);
    }
    return static_cast<double>(at.most_per_m2[(place[2] * at.along[1] + place[1]) * at.along[0] + place[0]]);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const level& l : levels_) bytes += asperity::heap_bytes(l.most_per_m2);
    return bytes;
  }

  friend bool operator==(const third_bounds&, const third_bounds&) = default;

 private:
  /// Blocks of a side of 2, 4, ... cells. A number holds for its block and half a block around it.
  struct level {
    std::array<std::size_t, 3> along{};
    std::vector<float> most_per_m2;
    friend bool operator==(const level&, const level&) = default;
  };

  [[nodiscard]] static level coarser(const level& of) {
    level spread_out = of, out;
    for (std::size_t k = 0; k < 3; ++k) {
      spread(spread_out.most_per_m2, of.along, k);
      out.along[k] = (of.along[k] + 1) / 2;
    }
    out.most_per_m2.resize(out.along[0] * out.along[1] * out.along[2]);
    std::size_t i = 0;
    for (std::size_t z = 0; z < of.along[2]; z += 2) {
      for (std::size_t y = 0; y < of.along[1]; y += 2) {
        for (std::size_t x = 0; x < of.along[0]; x += 2) {
          out.most_per_m2[i++] = spread_out.most_per_m2[(z * of.along[1] + y) * of.along[0] + x];
        }
      }
    }
    return out;
  }

  // Adds `times` the square of the largest third difference along three axes that a spline reads within a pitch of each
  // block.
  void add_squares(const coarse_grid& of, const std::array<std::size_t, 3>& axes, float times,
                   std::vector<float>& most) {
    std::fill(most.begin(), most.end(), 0.0F);
    const std::array<std::size_t, 3>& along = levels_[0].along;
    const std::array<std::size_t, 3> stride{1, of.nodes[0], of.nodes[0] * of.nodes[1]};
    std::array<std::size_t, 3> end = of.nodes;
    for (const std::size_t a : axes) end[a] -= 1;
    const std::size_t d = stride[axes[0]], e = stride[axes[1]], f = stride[axes[2]];
    std::vector<float> differences(end[0]);
    for (std::size_t z = 0; z < end[2]; ++z) {
      for (std::size_t y = 0; y < end[1]; ++y) {
        const float* const v = of.value.data() + of.at(0, y, z);
        for (std::size_t x = 0; x < end[0]; ++x) {
          const float* const n = v + x;
          const float near = (n[d + e] - n[d]) - (n[e] - n[0]);
          const float next = (n[d + e + f] - n[d + f]) - (n[e + f] - n[f]);
          differences[x] = std::fabs(next - near);
        }
        float* const blocks = most.data() + ((z / 2) * along[1] + y / 2) * along[0];
        for (std::size_t x = 0; x < end[0]; ++x) blocks[x / 2] = std::max(blocks[x / 2], differences[x]);
      }
    }
    for (std::size_t k = 0; k < 3; ++k) spread(most, along, k);
    for (std::size_t i = 0; i < most.size(); ++i) levels_[0].most_per_m2[i] += times * most[i] * most[i];
  }

  // Each number becomes the largest of those from one before it to two after it along an axis: within a pitch of a
  // block's two cells a spline reads nodes of these four.
  static void spread(std::vector<float>& most, const std::array<std::size_t, 3>& along, std::size_t axis) {
    std::size_t step = 1;
    for (std::size_t k = 0; k < axis; ++k) step *= along[k];
    const std::size_t n = along[axis];
    for (std::size_t first = 0; first < most.size(); first += step * n) {
      // Two rounds of the next neighbour, then one of the last: each reads what its own round has not changed yet.
      for (std::size_t i = 0; i + 1 < n; ++i) raise(most.data() + first + i * step, 1, step);
      for (std::size_t i = 0; i + 1 < n; ++i) raise(most.data() + first + i * step, 1, step);
      for (std::size_t i = n - 1; i > 0; --i) raise(most.data() + first + i * step, -1, step);
    }
  }

  // Each of `step` numbers in a row becomes at least as large as its neighbour, `step` numbers on or back.
  static void raise(float* row, std::ptrdiff_t to, std::size_t step) noexcept {
    const float* const other = row + to * static_cast<std::ptrdiff_t>(step);
    for (std::size_t i = 0; i < step; ++i) row[i] = std::max(row[i], other[i]);
  }

  vec3 low_{0.0};
  double pitch_m_ = 1.0;
  std::array<level, 4> levels_;
};

}  // namespace asperity::detail
