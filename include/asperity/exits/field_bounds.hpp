// What bounds the smooth part of a depth field in a ball.
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
#include "asperity/field/body_field.hpp"
#include "asperity/field/bspline.hpp"
#include "asperity/field/coarse_grid.hpp"

namespace asperity::exits {

/// S at a point, metres: coarse_grid::read() without derivatives, at a third of its cost.
/// @rt safe
[[nodiscard]] inline double smooth_depth(const detail::coarse_grid& grid, const vec3& p_b) noexcept {
  const vec3 c_b = grid.clamped(p_b);
  std::size_t first[3];
  double f[3];
  const double per_pitch = 1.0 / grid.pitch_m;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double g = (c_b[axis] - grid.low[axis]) * per_pitch;
    first[k] = static_cast<std::size_t>(std::min(std::max(1.0, g), static_cast<double>(grid.nodes[k]) - 3.0));
    f[k] = g - static_cast<double>(first[k]);
    --first[k];
  }
  const detail::cubic_weights wx(f[0]), wy(f[1]), wz(f[2]);
  double v = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    double s = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      const float* const row = grid.value.data() + grid.at(first[0], first[1] + j, first[2] + k);
      s += wy.value[j] * (wx.value[0] * static_cast<double>(row[0]) + wx.value[1] * static_cast<double>(row[1]) +
                          wx.value[2] * static_cast<double>(row[2]) + wx.value[3] * static_cast<double>(row[3]));
    }
    v += wz.value[k] * s;
  }
  if (c_b != p_b) v -= glm::length(p_b - c_b);
  return v;
}

/// Bounds of S for one body. Made once, beside the field; never changed.
class field_bounds {
 public:
  field_bounds() = default;

  /// Allocates two numbers per node of the grid.
  explicit field_bounds(const detail::coarse_grid& grid) : grid_(&grid) {
    find_highest();
    find_bend();
    find_steepest();
  }

  /// No slope of S within the grid is larger. Measured at and between the nodes, with a margin of 5 %.
  [[nodiscard]] double steepest() const noexcept { return steepest_; }

  /// Upper bound of S at the points within radius_m of p_b, from a table: no reading. @rt safe
  [[nodiscard]] double most_by_table(const vec3& p_b, double radius_m) const noexcept {
    const vec3 c_b = grid_->clamped(p_b), beyond = p_b - c_b;
    const double squared = glm::dot(beyond, beyond);
    if (!(squared > 0.0)) return static_cast<double>(highest_[nearest(c_b)]) + steepest_ * radius_m;
    // Outside the grid S is the value on its rim less the distance; inside, a part of the ball remains.
    if (squared >= radius_m * radius_m) return rim_m_ - (std::sqrt(squared) - radius_m);
    const double inside_m = std::sqrt(radius_m * radius_m - squared);
    return std::max(rim_m_, static_cast<double>(highest_[nearest(c_b)]) + steepest_ * inside_m);
  }

  /// No second derivative of S within radius_m of a point is larger (Frobenius norm), 1/m. Infinity beyond 15 pitches
  /// and for points outside the grid. @rt safe
  [[nodiscard]] double bend_per_m(const vec3& p_b, double radius_m) const noexcept {
    if (grid_->clamped(p_b) != p_b) return std::numeric_limits<double>::infinity();
    std::size_t l = 0;
    while (l < bend_.size() && radius_m > bend_[l].radius_m) ++l;
    if (l == bend_.size()) return std::numeric_limits<double>::infinity();
    const bend_level& at = bend_[l];
    std::size_t n[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double node = (p_b[axis] - grid_->low[axis]) / grid_->pitch_m + 0.5;
      n[k] = std::min(static_cast<std::size_t>(node) >> at.shift, at.cells[k] - 1);
    }
    return static_cast<double>(at.most[(n[2] * at.cells[1] + n[1]) * at.cells[0] + n[0]]);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(highest_, bend_); }

 private:
  [[nodiscard]] std::size_t nearest(const vec3& clamped_b) const noexcept {
    std::size_t n[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (clamped_b[axis] - grid_->low[axis]) / grid_->pitch_m + 0.5;
      n[k] = static_cast<std::size_t>(std::min(std::max(1.0, g), static_cast<double>(grid_->nodes[k]) - 2.0));
    }
    return grid_->at(n[0], n[1], n[2]);
  }

  [[nodiscard]] std::size_t stride(std::size_t axis) const noexcept {
    return axis == 0 ? 1 : (axis == 1 ? grid_->nodes[0] : grid_->nodes[0] * grid_->nodes[1]);
  }

  /// The largest second derivative about cells of 2^shift nodes.
  struct bend_level {
    std::size_t shift = 0;
    double radius_m = 0.0;  ///< within which it holds for every point of a cell
    std::array<std::size_t, 3> cells{};
    std::vector<float> most;
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(most); }
  };

  // Each number becomes the largest of its 27 neighbours.
  static void spread(std::vector<float>& v, const std::array<std::size_t, 3>& nodes) {
    std::size_t d = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<float> in = v;
      const std::size_t n = nodes[axis];
      for (std::size_t i = 0; i < in.size(); ++i) {
        const std::size_t along = i / d % n;
        if (along > 0) v[i] = std::max(v[i], in[i - d]);
        if (along + 1 < n) v[i] = std::max(v[i], in[i + d]);
      }
      d *= n;
    }
  }

  // A spline lies below the largest of its coefficients. About the node next to a point the 27 nodes are not all that
  // the spline reads there, but those beyond have no more than 1/48 of the weight each way, and a distance differs
  // there by a pitch at most: that is added.
  void find_highest() {
    highest_ = grid_->value;
    spread(highest_, grid_->nodes);
    const auto more = static_cast<float>(3.0 / 48.0 * 2.0 * grid_->pitch_m);
    for (float& v : highest_) v += more;
    const auto& n = grid_->nodes;
    for (std::size_t i = 0; i < grid_->value.size(); ++i) {
      const std::size_t x = i % n[0], y = i / n[0] % n[1], z = i / (n[0] * n[1]);
      const bool rim = x < 3 || y < 3 || z < 3 || x + 3 >= n[0] || y + 3 >= n[1] || z + 3 >= n[2];
      if (rim) rim_m_ = std::max(rim_m_, static_cast<double>(grid_->value[i]));
    }
  }

  // Second differences of the coefficients bound the spline's second derivatives, which are averages of those at up to
  // two nodes away. A ball about a point of a cell reaches no further than the cells next to it, less half a node.
  void find_bend() {
    const auto& n = grid_->nodes;
    const double per_square = 1.0 / (grid_->pitch_m * grid_->pitch_m);
    bend_level level{0, 0.5 * grid_->pitch_m, n, std::vector<float>(grid_->value.size(), 0.0F)};
    for (std::size_t z = 1; z + 1 < n[2]; ++z) {
      for (std::size_t y = 1; y + 1 < n[1]; ++y) {
        for (std::size_t x = 1; x + 1 < n[0]; ++x) {
          const std::size_t i = grid_->at(x, y, z);
          level.most[i] = static_cast<float>(1.0001 * per_square * second_difference(i));
        }
      }
    }
    spread(level.most, n);
    spread(level.most, n);
    for (;;) {
      bend_level next = halved(level);
      spread(level.most, level.cells);
      bend_.push_back(std::move(level));
      if (next.shift > 4) return;
      level = std::move(next);
    }
  }

  [[nodiscard]] bend_level halved(const bend_level& of) const {
    bend_level to;
    to.shift = of.shift + 1;
    to.radius_m = (static_cast<double>(std::size_t{1} << to.shift) - 0.5) * grid_->pitch_m;
    for (std::size_t k = 0; k < 3; ++k) to.cells[k] = (of.cells[k] + 1) / 2;
    to.most.assign(to.cells[0] * to.cells[1] * to.cells[2], 0.0F);
    std::size_t i = 0;
    for (std::size_t z = 0; z < of.cells[2]; ++z) {
      for (std::size_t y = 0; y < of.cells[1]; ++y) {
        for (std::size_t x = 0; x < of.cells[0]; ++x, ++i) {
          float& cell = to.most[((z / 2) * to.cells[1] + y / 2) * to.cells[0] + x / 2];
          cell = std::max(cell, of.most[i]);
        }
      }
    }
    return to;
  }

  [[nodiscard]] double second_difference(std::size_t i) const noexcept {
    const auto value = [&](std::size_t k) { return static_cast<double>(grid_->value[k]); };
    double squares = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t d = stride(a);
      const double bend = value(i + d) - 2.0 * value(i) + value(i - d);
      squares += bend * bend;
      for (std::size_t b = a + 1; b < 3; ++b) {
        const std::size_t e = stride(b);
        double most = 0.0;
        for (const std::size_t at : {i, i - d, i - e, i - d - e}) {
          most = std::max(most, std::fabs(value(at + d + e) - value(at + d) - value(at + e) + value(at)));
        }
        squares += 2.0 * most * most;
      }
    }
    return std::sqrt(squares);
  }

  void find_steepest() {
    const auto& n = grid_->nodes;
    double most = 0.0;
    for (std::size_t z = 1; z + 2 < n[2]; ++z) {
      for (std::size_t y = 1; y + 2 < n[1]; ++y) {
        for (std::size_t x = 1; x + 2 < n[0]; ++x) {
          const vec3 slope = node_slope(grid_->at(x, y, z));
          most = std::max(most, glm::dot(slope, slope));
        }
      }
    }
    steepest_ = std::max(1.0, 1.05 * std::sqrt(most));
  }

  // In the middle of a cell, from its eight corners: sharper than the spline, which averages such slopes.
  [[nodiscard]] vec3 node_slope(std::size_t i) const noexcept {
    vec3 out(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t d = stride(static_cast<std::size_t>(axis));
      const std::size_t e = stride(static_cast<std::size_t>((axis + 1) % 3));
      const std::size_t f = stride(static_cast<std::size_t>((axis + 2) % 3));
      double rise = 0.0;
      for (const std::size_t at : {i, i + e, i + f, i + e + f}) {
        rise += static_cast<double>(grid_->value[at + d]) - static_cast<double>(grid_->value[at]);
      }
      out[axis] = rise / (4.0 * grid_->pitch_m);
    }
    return out;
  }

  const detail::coarse_grid* grid_ = nullptr;
  std::vector<float> highest_;
  std::vector<bend_level> bend_;
  double steepest_ = 1.0;
  double rim_m_ = -std::numeric_limits<double>::infinity();
};

}  // namespace asperity::exits
