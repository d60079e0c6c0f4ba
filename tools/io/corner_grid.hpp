// Corners of a polygon in the cells of a grid, so that a triangle meets few of those that it does not hold.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"

namespace asperity::io {

/// As many cells as corners, as many columns as rows: a triangle across all of them meets few, however long it is.
class corner_grid {
 public:
  /// @param corners numbers of points. @pre the points outlive the grid
  void fill(const std::vector<vec2>& points, std::span<const std::uint32_t> corners) {
    points_ = &points;
    low_ = high_ = points[corners[0]];
    for (const std::uint32_t c : corners) {
      low_ = glm::min(low_, points[c]);
      high_ = glm::max(high_, points[c]);
    }
    const vec2 size = high_ - low_;
    cells_[0] = cells_[1] = std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(corners.size())));
    for (int i = 0; i < 2; ++i) per_m_[i] = size[i] > 0.0 ? static_cast<double>(cells_[i]) / size[i] : 0.0;
    first_.assign(cells_[0] * cells_[1] + 1, 0);
    for (const std::uint32_t c : corners) ++first_[cell_of(points[c]) + 1];
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    sorted_.resize(corners.size());
    std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
    for (const std::uint32_t c : corners) sorted_[at[cell_of(points[c])]++] = c;
  }

  /// Calls visit(corner) for every corner in a cell that the triangle a, b, c touches, until one returns true.
  /// @param work counts cells and corners @return whether one did
  template <class Visit>
  bool any_near(const vec2& a, const vec2& b, const vec2& c, std::size_t& work, const Visit& visit) const {
    const std::size_t top = row_of(std::max({a.y, b.y, c.y}));
    for (std::size_t j = row_of(std::min({a.y, b.y, c.y})); j <= top; ++j) {
      const auto [from, to] = columns(a, b, c, j);
      work += 1 + to - from;
      const std::size_t begin = first_[j * cells_[0] + from];
      const std::size_t end = first_[j * cells_[0] + to + 1];
      work += end - begin;
      if (std::any_of(sorted_.begin() + static_cast<std::ptrdiff_t>(begin),
                      sorted_.begin() + static_cast<std::ptrdiff_t>(end), visit)) {
        return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] std::size_t place(double x, int axis) const noexcept {
    const double cells = (x - low_[axis]) * per_m_[axis];
    return cells > 0.0 ? std::min(static_cast<std::size_t>(std::min(cells, 1e9)), cells_[axis] - 1) : 0;
  }
  [[nodiscard]] std::size_t row_of(double y) const noexcept { return place(y, 1); }
  [[nodiscard]] std::size_t cell_of(const vec2& p) const noexcept { return row_of(p.y) * cells_[0] + place(p.x, 0); }

  /// Columns that the triangle touches in row j, a little more rather than less: its sides within the row's height.
  [[nodiscard]] std::pair<std::size_t, std::size_t> columns(const vec2& a, const vec2& b, const vec2& c,
                                                            std::size_t j) const noexcept {
    const double slack = 1e-6;  // of a cell
    const double row = per_m_.y > 0.0 ? 1.0 / per_m_.y : 0.0;
    const double y0 = per_m_.y > 0.0 ? low_.y + (static_cast<double>(j) - slack) * row : low_.y;
    const double y1 = per_m_.y > 0.0 ? low_.y + (static_cast<double>(j) + 1.0 + slack) * row : high_.y;
    double left = high_.x;
    double right = low_.x;
    const auto side = [&](const vec2& p, const vec2& q) {
      const vec2& lower = p.y < q.y ? p : q;
      const vec2& upper = p.y < q.y ? q : p;
      if (lower.y > y1 || upper.y < y0) return;
      const double rise = upper.y - lower.y;
      const auto x_at = [&](double y) {
        return rise > 0.0 ? lower.x + (upper.x - lower.x) * std::clamp((y - lower.y) / rise, 0.0, 1.0) : lower.x;
      };
      const double x0 = x_at(y0);
      const double x1 = rise > 0.0 ? x_at(y1) : upper.x;
      left = std::min({left, x0, x1});
      right = std::max({right, x0, x1});
    };
    side(a, b);
    side(b, c);
    side(c, a);
    const double pad = per_m_.x > 0.0 ? slack / per_m_.x : 0.0;
    const std::size_t from = place(left - pad, 0);
    return {from, std::max(from, place(right + pad, 0))};
  }

  const std::vector<vec2>* points_ = nullptr;
  vec2 low_{0.0}, high_{0.0}, per_m_{0.0};
  std::size_t cells_[2] = {1, 1};      // columns and rows
  std::vector<std::uint32_t> first_;   // per cell, the first of its corners in sorted_
  std::vector<std::uint32_t> sorted_;  // corners by cell
};

}  // namespace asperity::io
