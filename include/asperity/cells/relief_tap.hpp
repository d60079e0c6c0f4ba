// Reads a relief map between its nodes.
#pragma once

#include <cmath>
#include <cstddef>

#include "asperity/cells/surface_cells.hpp"

namespace asperity::detail {

/// Height and clearance over a point of a cell's plane, with their slopes along the cell's u and v.
struct relief_tap {
  double height_m = 0.0, clearance_m = 0.0;
  vec2 height_slope{0.0}, clearance_slope{0.0};
};

/// Weights of Catmull and Rom's spline for four nodes at -1, 0, 1, 2, and their derivatives, at 0 <= f < 1.
struct spline_weights {
  double value[4], slope[4];
  explicit spline_weights(double f) noexcept {
    const double f2 = f * f, f3 = f2 * f;
    value[0] = -0.5 * f3 + f2 - 0.5 * f;
    value[1] = 1.5 * f3 - 2.5 * f2 + 1.0;
    value[2] = -1.5 * f3 + 2.0 * f2 + 0.5 * f;
    value[3] = 0.5 * (f3 - f2);
    slope[0] = -1.5 * f2 + 2.0 * f - 0.5;
    slope[1] = 4.5 * f2 - 5.0 * f;
    slope[2] = -4.5 * f2 + 4.0 * f + 0.5;
    slope[3] = 1.5 * f2 - f;
  }
};

/// A cell's map. Continuous with its slope everywhere, which is what makes the wrench continuous.
class relief_map {
 public:
  relief_map(const surface_cells& body, const surface_cell& cell) noexcept
      : cell_(&cell), nodes_(body.nodes.data() + cell.first), per_pitch_(1.0 / cell.pitch_m) {}

  /// Where in the grid a point lies; false outside, where the cell has no clearance.
  struct place {
    std::size_t column, row;
    double x, y;  ///< between nodes, 0 to 1
  };
  [[nodiscard]] bool find(double x_m, double y_m, place& out) const noexcept {
    const double gx = (x_m - cell_->low.x) * per_pitch_, gy = (y_m - cell_->low.y) * per_pitch_;
    if (!(gx >= 1.0 && gy >= 1.0 && gx < cell_->columns - 2.0 && gy < cell_->rows - 2.0)) return false;
    out.column = static_cast<std::size_t>(gx);
    out.row = static_cast<std::size_t>(gy);
    out.x = gx - static_cast<double>(out.column);
    out.y = gy - static_cast<double>(out.row);
    return true;
  }

  /// The node at a place's lower corner: enough to see that a sample is far from touching.
  [[nodiscard]] const relief_node& near_node(const place& at) const noexcept {
    return nodes_[at.row * cell_->columns + at.column];
  }

  [[nodiscard]] relief_tap read(const place& at) const noexcept {
    const spline_weights wx(at.x), wy(at.y);
    double h = 0.0, hx = 0.0, hy = 0.0, c = 0.0, cx = 0.0, cy = 0.0;
    for (std::size_t r = 0; r < 4; ++r) {
      const relief_node* const n = nodes_ + (at.row + r - 1) * cell_->columns + (at.column - 1);
      double row_h = 0.0, row_hx = 0.0, row_c = 0.0, row_cx = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double height = n[k].height_m, clearance = n[k].clearance_m;
        row_h += wx.value[k] * height;
        row_hx += wx.slope[k] * height;
        row_c += wx.value[k] * clearance;
        row_cx += wx.slope[k] * clearance;
      }
      h += wy.value[r] * row_h;
      hx += wy.value[r] * row_hx;
      hy += wy.slope[r] * row_h;
      c += wy.value[r] * row_c;
      cx += wy.value[r] * row_cx;
      cy += wy.slope[r] * row_c;
    }
    return {h, c, per_pitch_ * vec2(hx, hy), per_pitch_ * vec2(cx, cy)};
  }

 private:
  const surface_cell* cell_;
  const relief_node* nodes_;
  double per_pitch_;
};

}  // namespace asperity::detail
