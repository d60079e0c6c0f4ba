// Heights of one body over the window's samples, and the raster that finds which coarse triangle is seen by each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/window/window_depth_settings.hpp"
#include "window/patch_projection.hpp"

namespace asperity::detail {

/// Kind of surface found over a sample.
enum class hit : std::uint8_t {
  none,    ///< no surface, or a NaN texel
  coarse,  ///< a coarse triangle; the texture was not read yet
  beside,  ///< the texel of the coarse hit (paper, Eq. 8): its fine point may lie beside the sample
  above,   ///< the point of the textured surface that lies over the sample
};

/// Structure of arrays over the grid's samples, row by row.
struct height_field {
  std::vector<double> height;        ///< along n from the window's centre, m
  std::vector<hit> kind;             ///< where it is hit::none, the other arrays mean nothing
  std::vector<std::uint32_t> owner;  ///< index in patch_projection::triangles() of the coarse triangle that is seen
  std::vector<vec2> texel;           ///< where the texture was read, texels

  explicit height_field(std::size_t samples) : height(samples), kind(samples), owner(samples), texel(samples) {}
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(height, kind, owner, texel); }
};

/// Signed side of a line through two projected vertices.
/// The coefficients come from the vertices in the order of their indices, so the two triangles of an edge compute the
/// same number and its negative: a sample on the edge belongs to both, and none falls between them.
struct edge_side {
  double per_u, per_v, constant;

  edge_side(const projected_triangle& t, std::size_t k, double orientation) noexcept {
    std::size_t a = k;
    std::size_t b = (k + 1) % 3;
    double s = orientation;
    if (t.vertex[a] > t.vertex[b]) {
      std::swap(a, b);
      s = -s;
    }
    const vec3& p = t.corner[a];
    const vec3& q = t.corner[b];
    const double du = q.x - p.x;
    const double dv = q.y - p.y;
    per_u = -s * dv;
    per_v = s * du;
    constant = s * (dv * p.x - du * p.y);
  }
  [[nodiscard]] double operator()(double u, double row) const noexcept { return per_u * u + row; }
  [[nodiscard]] double row(double v) const noexcept { return per_v * v + constant; }
};

/// Where a row's samples inside an edge begin, or end. An edge function grows or shrinks along a row, rounded or not,
/// so its samples inside are one run; its end moves little from row to row, and is searched from where it was.
class edge_run {
 public:
  edge_run(const edge_side& edge, std::size_t first, std::size_t end) noexcept
      : edge_(edge), first_(first), end_(end), at_(edge.per_u > 0.0 ? end : first) {}

  /// Cuts [first, end) down to the samples of row v that are not outside the edge.
  /// @param u  coordinate of each column
  void cut(const double* u, double v, std::size_t& first, std::size_t& end) noexcept {
    const double row = edge_.row(v);
    const auto outside = [&](std::size_t column) { return edge_(u[column], row) < 0.0; };
    if (edge_.per_u > 0.0) {
      while (at_ > first_ && !outside(at_ - 1)) --at_;
      while (at_ < end_ && outside(at_)) ++at_;
      first = std::max(first, at_);
    } else if (edge_.per_u < 0.0) {
      while (at_ < end_ && !outside(at_)) ++at_;
      while (at_ > first_ && outside(at_ - 1)) --at_;
      end = std::min(end, at_);
    } else if (first < end && outside(first)) {
      end = first;
    }
  }

 private:
  edge_side edge_;
  std::size_t first_, end_;  // columns of the triangle's box
  std::size_t at_;
};

/// Finds the coarse triangle over each sample: of several layers the one that `which` names. Fills kind, owner and the
/// coarse height.
/// @pre grid.side <= window_depth_settings::max_grid
/// @rt safe   @source paper section 5.1 (orthographic projection along n)
inline void rasterise(const patch_projection& patch, const sample_grid& grid, layer which, height_field& out) noexcept {
  std::fill_n(out.kind.begin(), grid.size(), hit::none);
  const double s = sign(which);
  std::array<double, window_depth_settings::max_grid> u;  // an integer is slow to turn into a number
  for (std::size_t i = 0; i < grid.side; ++i) u[i] = grid.coordinate(i);
  for (std::uint32_t t = 0; t < patch.triangles().size(); ++t) {
    const projected_triangle& tri = patch.triangles()[t];
    const auto [c0, c1, c2] = tri.corner;
    // The box is slightly larger than the triangle, so that only the edges decide about a sample that lies on one.
    const double slack = 1e-3 * grid.pitch_m;
    const std::size_t first_column = grid.first_at(std::min({c0.x, c1.x, c2.x}) - slack);
    const std::size_t end_column = grid.end_at(std::max({c0.x, c1.x, c2.x}) + slack);
    const std::size_t first_row = grid.first_at(std::min({c0.y, c1.y, c2.y}) - slack);
    const std::size_t end_row = grid.end_at(std::max({c0.y, c1.y, c2.y}) + slack);
    // Seen along n, A's facing triangles turn counter-clockwise and B's clockwise.
    std::array runs{edge_run(edge_side(tri, 0, s), first_column, end_column),
                    edge_run(edge_side(tri, 1, s), first_column, end_column),
                    edge_run(edge_side(tri, 2, s), first_column, end_column)};
    for (std::size_t row = first_row; row < end_row; ++row) {
      const double v = grid.coordinate(row);
      std::size_t first = first_column, end = end_column;
      for (edge_run& r : runs) r.cut(u.data(), v, first, end);
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

}  // namespace asperity::detail
