// Heights of one body over the window's samples, and the raster that finds which coarse triangle is seen by each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "asperity/depth/patch_projection.hpp"

namespace asperity::detail {

/// What was found over a sample.
enum class hit : std::uint8_t {
  none,    ///< no surface, or a NaN texel
  coarse,  ///< a coarse triangle; the texture was not read yet
  beside,  ///< the texel of the coarse hit (paper, Eq. 8): its fine point may lie beside the sample
  above,   ///< the point of the textured surface that lies over the sample
};

/// Structure of arrays over the grid's samples, row by row.
struct height_field {
  std::vector<double> height;        ///< along n from the window's centre, m
  std::vector<hit> kind;             ///< where it is none, the other arrays mean nothing
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

/// Finds the coarse triangle over each sample: of several layers the one that `which` names. Fills kind, owner and the
/// coarse height.
/// @rt safe   @source paper section 5.1 (orthographic projection along n)
inline void rasterise(const patch_projection& patch, const sample_grid& grid, layer which, height_field& out) noexcept {
  std::fill_n(out.kind.begin(), grid.size(), hit::none);
  const double s = sign(which);
  for (std::uint32_t t = 0; t < patch.triangles().size(); ++t) {
    const projected_triangle& tri = patch.triangles()[t];
    const auto [c0, c1, c2] = tri.corner;
    // The box is a shade larger than the triangle, so that only the edges decide about a sample that lies on one.
    const double slack = 1e-3 * grid.pitch_m;
    const std::size_t first_column = grid.first_at(std::min({c0.x, c1.x, c2.x}) - slack);
    const std::size_t end_column = grid.end_at(std::max({c0.x, c1.x, c2.x}) + slack);
    const std::size_t first_row = grid.first_at(std::min({c0.y, c1.y, c2.y}) - slack);
    const std::size_t end_row = grid.end_at(std::max({c0.y, c1.y, c2.y}) + slack);
    // Seen along n, A's facing triangles turn counter-clockwise and B's clockwise.
    const edge_side e0(tri, 0, s), e1(tri, 1, s), e2(tri, 2, s);
    for (std::size_t row = first_row; row < end_row; ++row) {
      const double v = grid.coordinate(row);
      const double r0 = e0.row(v), r1 = e1.row(v), r2 = e2.row(v);
      for (std::size_t column = first_column; column < end_column; ++column) {
        const double u = grid.coordinate(column);
        if (e0(u, r0) < 0.0 || e1(u, r1) < 0.0 || e2(u, r2) < 0.0) continue;
        const std::size_t i = grid.index(column, row);
        const double h = tri.height(u, v);
        if (out.kind[i] != hit::none && s * (h - out.height[i]) <= 0.0) continue;
        out.kind[i] = hit::coarse;
        out.height[i] = h;
        out.owner[i] = t;
      }
    }
  }
}

}  // namespace asperity::detail
