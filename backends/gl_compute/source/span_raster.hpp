// The CPU backend's raster, a row at a time: the same decisions to the bit for half the instructions.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/depth/height_field.hpp"
#include "asperity/depth/settings.hpp"

namespace asperity::gl {

/// Where a row's samples inside an edge begin, or end. An edge function grows or shrinks along a row, rounded or not,
/// so its samples inside are one run; its end moves little from row to row, and is searched from where it was.
class edge_run {
 public:
  edge_run(const detail::edge_side& edge, std::size_t first, std::size_t end) noexcept
      : edge_(edge), grows_(edge.per_u > 0.0), shrinks_(edge.per_u < 0.0), at_(grows_ ? end : first) {}

  /// Cuts [first, end) down to the samples of row v that are not outside the edge.
  /// @param u  coordinate of each column
  void cut(const double* u, double v, std::size_t box_first, std::size_t box_end, std::size_t& first,
           std::size_t& end) noexcept {
    const double row = edge_.row(v);
    const auto outside = [&](std::size_t column) { return edge_(u[column], row) < 0.0; };
    if (grows_) {
      while (at_ > box_first && !outside(at_ - 1)) --at_;
      while (at_ < box_end && outside(at_)) ++at_;
      first = std::max(first, at_);
    } else if (shrinks_) {
      while (at_ < box_end && !outside(at_)) ++at_;
      while (at_ > box_first && outside(at_ - 1)) --at_;
      end = std::min(end, at_);
    } else if (first < end && outside(first)) {
      end = first;
    }
  }

 private:
  const detail::edge_side& edge_;
  bool grows_, shrinks_;
  std::size_t at_;
};

/// As detail::rasterise. @rt safe
inline void rasterise_spans(const detail::patch_projection& patch, const detail::sample_grid& grid, detail::layer which,
                            detail::height_field& out) noexcept {
  using detail::hit;
  std::fill_n(out.kind.begin(), grid.size(), hit::none);
  const double s = sign(which);
  std::array<double, depth_settings::max_grid> u;  // an integer is slow to turn into a number
  for (std::size_t i = 0; i < grid.side; ++i) u[i] = grid.coordinate(i);
  for (std::uint32_t t = 0; t < patch.triangles().size(); ++t) {
    const detail::projected_triangle& tri = patch.triangles()[t];
    const auto [c0, c1, c2] = tri.corner;
    const double slack = 1e-3 * grid.pitch_m;
    const std::size_t first_column = grid.first_at(std::min({c0.x, c1.x, c2.x}) - slack);
    const std::size_t end_column = grid.end_at(std::max({c0.x, c1.x, c2.x}) + slack);
    const std::size_t first_row = grid.first_at(std::min({c0.y, c1.y, c2.y}) - slack);
    const std::size_t end_row = grid.end_at(std::max({c0.y, c1.y, c2.y}) + slack);
    const std::array<detail::edge_side, 3> edges{detail::edge_side(tri, 0, s), detail::edge_side(tri, 1, s),
                                                 detail::edge_side(tri, 2, s)};
    std::array<edge_run, 3> runs{edge_run(edges[0], first_column, end_column),
                                 edge_run(edges[1], first_column, end_column),
                                 edge_run(edges[2], first_column, end_column)};
    for (std::size_t row = first_row; row < end_row; ++row) {
      const double v = grid.coordinate(row);
      std::size_t first = first_column, end = end_column;
      for (edge_run& r : runs) r.cut(u.data(), v, first_column, end_column, first, end);
      for (std::size_t column = first; column < end; ++column) {
        const std::size_t i = grid.index(column, row);
        const double h = tri.height(u[column], v);
        if (out.kind[i] != hit::none && s * (h - out.height[i]) <= 0.0) continue;
        out.kind[i] = hit::coarse;
        out.height[i] = h;
        out.owner[i] = t;
      }
    }
  }
}

}  // namespace asperity::gl
