// Upper bounds of the moving shape of a body in a ball.
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
#include "field/threads.hpp"
#include "least_motion/finer_bricks.hpp"
#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// Bounds of the moving shape S' of one body. Made once, beside the shape; never changed.
class field_bounds {
 public:
  /// Allocates two numbers per node of the grid.
  /// @param shape  whose grid must outlive the bounds
  /// @param threads that work at once; the bounds do not depend on them
  field_bounds(const moving_shape& shape, unsigned threads) : grid_(&shape.grid()) {
    bend_level level;
    std::vector<finer_brick> finer;
    detail::for_each_task(2, threads, [&](std::size_t task) {
      if (task == 0) {
        find_highest();
        find_steepest();
        level = least_bend();
      } else {
        finer = measured_bricks(shape, threads);
      }
    });
    steepest_of_smooth_ = steepest_;
    for (const finer_brick& of : finer) add(of, level);
    spread_bend(std::move(level));
  }

  /// No slope of S' within the grid is larger. Measured at and between the nodes, with a margin of 5 %.
  [[nodiscard]] double steepest() const noexcept { return steepest_; }
  /// No slope of S itself is larger.
  [[nodiscard]] double steepest_of_smooth() const noexcept { return steepest_of_smooth_; }

  /// Upper bound of S' and of S at the points within radius_m of p_b, from a table: no reading. @rt safe
  [[nodiscard]] double most_by_table(const vec3& p_b, double radius_m) const noexcept {
    const vec3 c_b = grid_->clamped(p_b), beyond = p_b - c_b;
    const double squared = glm::dot(beyond, beyond);
    if (!(squared > 0.0)) return static_cast<double>(highest_[nearest(c_b)]) + steepest_ * radius_m;
    // Outside the grid S is the value on its rim less the distance; inside, a part of the ball remains.
    if (squared >= radius_m * radius_m) return rim_m_ - (std::sqrt(squared) - radius_m);
    const double inside_m = std::sqrt(radius_m * radius_m - squared);
    return std::max(rim_m_, static_cast<double>(highest_[nearest(c_b)]) + steepest_ * inside_m);
  }

  /// No second derivative of S' within radius_m of a point is larger (Frobenius norm), 1/m. Infinity beyond 15 pitches
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
  // two nodes away. For points that are next to a node.
  [[nodiscard]] bend_level least_bend() const {
    const auto& n = grid_->nodes;
    const double per_square = 1.0 / (grid_->pitch_m * grid_->pitch_m);
    const float* const value = grid_->value.data();
    const std::size_t stride[3] = {1, n[0], n[0] * n[1]};
    bend_level level{0, 0.5 * grid_->pitch_m, n, std::vector<float>(grid_->value.size(), 0.0F)};
    for (std::size_t z = 1; z + 1 < n[2]; ++z) {
      for (std::size_t y = 1; y + 1 < n[1]; ++y) {
        for (std::size_t x = 1; x + 1 < n[0]; ++x) {
          const std::size_t i = grid_->at(x, y, z);
          level.most[i] = static_cast<float>(1.0001 * per_square * std::sqrt(squared_difference(value + i, stride)));
        }
      }
    }
    spread(level.most, n);
    spread(level.most, n);
    return level;
  }

  // A ball about a point of a cell reaches no further than the cells next to it, less half a node.
  void spread_bend(bend_level level) {
    for (;;) {
      bend_level next = halved(level);
      spread(level.most, level.cells);
      bend_.push_back(std::move(level));
      if (next.shift > 4) return;
      level = std::move(next);
    }
  }

  void add(const finer_brick& brick, bend_level& level) {
    for (std::size_t c = 0; c < brick.cells.size(); ++c) {
      const std::array<std::size_t, 3> node = brick.node_of(c);
      if (!finer_brick::is_cell(*grid_, node)) continue;
      for (const std::size_t at : corners(grid_->at(node[0], node[1], node[2]))) {
        highest_[at] = std::max(highest_[at], brick.cells[c].highest_m);
        level.most[at] = std::max(level.most[at], brick.cells[c].bend_per_m);
      }
    }
    const double per_pitch = static_cast<double>(moving_shape::finer) / grid_->pitch_m;
    steepest_ = std::max(steepest_, margin * per_pitch * std::sqrt(brick.steepest_squared));
  }

  [[nodiscard]] std::array<std::size_t, 8> corners(std::size_t first) const noexcept {
    std::array<std::size_t, 8> out{};
    for (std::size_t c = 0; c < 8; ++c) {
      out[c] = first + (c & 1U) + (c >> 1 & 1U) * grid_->nodes[0] + (c >> 2) * grid_->nodes[0] * grid_->nodes[1];
    }
    return out;
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

  void find_steepest() {
    const auto& n = grid_->nodes;
    const std::size_t stride[3] = {1, n[0], n[0] * n[1]};
    double most = 1.0 / (margin * margin);
    for (std::size_t z = 1; z + 2 < n[2]; ++z) {
      for (std::size_t y = 1; y + 2 < n[1]; ++y) {
        for (std::size_t x = 1; x + 2 < n[0]; ++x) {
          // Cheap, and mostly larger than the spline's slopes, which are averages: those are read only where it exceeds
          // the largest so far.
          const vec3 middle = middle_slope(grid_->value.data() + grid_->at(x, y, z), stride) / grid_->pitch_m;
          if (glm::dot(middle, middle) <= most) continue;
          for (std::size_t c = 0; c < 8; ++c) {
            const vec3 in(0.5 * static_cast<double>(c & 1U), 0.5 * static_cast<double>(c >> 1 & 1U),
                          0.5 * static_cast<double>(c >> 2));
            const vec3 slope = grid_->read(grid_->low + grid_->pitch_m * (vec3(x, y, z) + in)).slope;
            most = std::max(most, glm::dot(slope, slope));
          }
        }
      }
    }
    steepest_ = margin * std::sqrt(most);
  }

  static constexpr double margin = 1.05;  // of the steepest slope, which is measured at points

  const detail::coarse_grid* grid_;
  std::vector<float> highest_;
  std::vector<bend_level> bend_;
  double steepest_ = 1.0, steepest_of_smooth_ = 1.0;
  double rim_m_ = -std::numeric_limits<double>::infinity();
};

}  // namespace asperity::exits
