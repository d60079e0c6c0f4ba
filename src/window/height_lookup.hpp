// From the coarse hit over a sample to the height of the textured surface there, and that height's derivative.
#pragma once

#include <cmath>
#include <cstdint>

#include "asperity/core/spatial.hpp"
#include "asperity/window/window_depth_settings.hpp"
#include "model/texture_tap.hpp"
#include "window/height_field.hpp"

namespace asperity::detail {

/// Everything on which a height over one body depends.
struct body_view {
  const haptic_texture& texture;
  const surface_index& index;
  const patch_projection& patch;
  const window_map& map;
};

/// Height at a sample, and where the texture was read for it.
struct fine_hit {
  hit kind = hit::none;
  double height = 0.0;  ///< m
  vec2 texel{0.0};
};

/// The paper's lookup: the texel of the coarse hit, whose fine point need not lie over the sample.
/// @source paper Eq. 8
[[nodiscard]] inline fine_hit look_beside(const body_view& body, const projected_triangle& t, const vec2& uv) noexcept {
  const vec2 z(t.texel_x(uv.x, uv.y), t.texel_y(uv.x, uv.y));
  const double h = body.map.origin.z + glm::dot(body.map.n_b, read(body.texture, z).point);
  return std::isfinite(h) ? fine_hit{hit::beside, h, z} : fine_hit{};
}

/// The point of the textured surface that lies over the sample, by Newton's method on the bilinear surface.
/// The search starts at the coarse hit. It may run into a chart's gutter by one texel; beyond that it goes on in the
/// triangle on the other side of the edge that it is farthest outside of. Where the surface folds over or its patch
/// ends first, the paper's lookup is used.
/// @source science, section 2 (parallax)
[[nodiscard]] inline fine_hit look_above(const body_view& body, const projected_triangle& start, const vec2& uv,
                                         double tolerance_m) noexcept {
  constexpr int max_steps = 12;
  constexpr double gutter_texels = 1.0;
  const projected_triangle* t = &start;
  vec2 z(t->texel_x(uv.x, uv.y), t->texel_y(uv.x, uv.y));
  texture_cell cell = texture_cell(body.texture, z).seen_by(body.map);
  for (int step = 0; step < max_steps; ++step) {
    if (!cell.holds(z)) cell = texture_cell(body.texture, z).seen_by(body.map);
    const auto [q, dx, dy] = cell.at(z);
    if (!is_finite(q)) {
      // Inside the triangle a NaN texel is a hole in the surface; outside, the chart's gutter is too narrow.
      const texel_triangle& chart = body.index.texels[t->triangle];
      if (chart.within(z, chart.barycentric(z), 0.0)) return {};
      break;
    }
    const double det = dx.x * dy.y - dx.y * dy.x;
    const double coarse_det = t->texel_x.per_u * t->texel_y.per_v - t->texel_x.per_v * t->texel_y.per_u;
    // On a fold the back of the fine surface faces the window: the determinant has the wrong sign.
    if (!(det * coarse_det > 0.02)) break;
    const vec2 miss(uv.x - q.x, uv.y - q.y);
    const vec2 dz = vec2(dy.y * miss.x - dy.x * miss.y, dx.x * miss.y - dx.y * miss.x) / det;
    // The last step goes along the tangents: what is left of the miss counts only in second order.
    if (std::fabs(miss.x) <= tolerance_m && std::fabs(miss.y) <= tolerance_m) {
      return {hit::above, q.z + dx.z * dz.x + dy.z * dz.y, z};
    }
    const bool from_inside = cell.spans(z);
    z += dz;

    const texel_triangle& chart = body.index.texels[t->triangle];
    const vec3 bary = chart.barycentric(z);
    if (chart.within(z, bary, gutter_texels)) {
      // Within one cell a step misses by the twist alone, so most steps are the last and need no second look. A step
      // from beyond the image's border is not within a cell: there the surface was read beside z.
      const vec3 left = (dz.x * dz.y) * cell.twist;
      if (from_inside && cell.spans(z) && cell.largest_twist() * glm::dot(dz, dz) <= tolerance_m) {
        return {hit::above, q.z + dx.z * dz.x + dy.z * dz.y + left.z, z};
      }
      continue;
    }
    const std::size_t outermost = chart.outermost(bary);
    // The edge opposite to corner k is edge k + 1.
    const projected_triangle* next = body.patch.find(body.index.neighbour[t->triangle][(outermost + 1) % 3]);
    if (next == nullptr) break;
    const vec3 coarse = bary.x * t->corner[0] + bary.y * t->corner[1] + bary.z * t->corner[2];
    t = next;
    z = {t->texel_x(coarse.x, coarse.y), t->texel_y(coarse.x, coarse.y)};
  }
  return look_beside(body, start, uv);
}

/// Replaces coarse heights by fine ones wherever `wanted(i)` holds; other samples are left as they are.
/// @return false where a NaN texel was met; its samples become hit::none   @rt safe
template <class Wanted>
[[nodiscard]] bool look_up(const body_view& body, const sample_grid& grid, parallax_mode mode, height_field& field,
                           Wanted wanted) noexcept {
  // The last step may cross a texel border, where the slope has a kink: what is left must be far below any depth.
  const double tolerance_m = 1e-10 * grid.half_m;
  bool all_finite = true;
  for (std::size_t row = 0, i = 0; row < grid.side; ++row) {
    const double v = grid.coordinate(row);
    for (std::size_t column = 0; column < grid.side; ++column, ++i) {
      if (field.kind[i] != hit::coarse || !wanted(i)) continue;
      const vec2 uv(grid.coordinate(column), v);
      const projected_triangle& t = body.patch.triangles()[field.owner[i]];
      const fine_hit f = mode == parallax_mode::exact ? look_above(body, t, uv, tolerance_m) : look_beside(body, t, uv);
      field.kind[i] = f.kind;
      field.height[i] = f.height;
      field.texel[i] = f.texel;
      all_finite = all_finite && f.kind != hit::none;
    }
  }
  return all_finite;
}

/// Fine point behind a sample, world frame.
[[nodiscard]] inline vec3 fine_point_w(const body_view& body, const contact_window& window,
                                       const vec2& texel) noexcept {
  return to_world(window, body.map.point(read(body.texture, texel).point));
}

/// Exact derivative of the height over a world-fixed sample by a motion of the body (translation of `centre_w`;
/// rotation about it), world axes. Its component along n is 1.
/// - above: the fine surface slides through the sample's line, dh = m . (velocity of the fine point X), m = N / (N .
/// n).
/// - beside: X is carried along, and the coarse hit Y moves over the coarse triangle by what keeps it on the line; with
///   s the slope of h over the window through the texture, dh = n . (velocity of X) - s . (velocity of Y).
/// @rt safe   @source science, section 3 (Danskin); the second form is the chain rule through Eq. 8
[[nodiscard]] inline vec6 height_gradient(const body_view& body, const contact_window& window,
                                          const height_field& field, std::size_t i, const vec2& uv,
                                          const vec3& centre_w) noexcept {
  const surface_tap tap = read(body.texture, field.texel[i]);
  const vec3 arm_x = to_world(window, body.map.point(tap.point)) - centre_w;
  const vec3 dx = body.map.direction(tap.along_x);
  const vec3 dy = body.map.direction(tap.along_y);
  if (field.kind[i] == hit::above) {
    const vec3 normal = glm::cross(dx, dy);
    const vec3 m = direction_to_world(window, {normal.x / normal.z, normal.y / normal.z, 1.0});
    return {m, glm::cross(arm_x, m)};
  }
  const projected_triangle& t = body.patch.triangles()[field.owner[i]];
  const vec3 slope = direction_to_world(
      window, {dx.z * t.texel_x.per_u + dy.z * t.texel_y.per_u, dx.z * t.texel_x.per_v + dy.z * t.texel_y.per_v, 0.0});
  const vec3 arm_y = to_world(window, {uv.x, uv.y, t.height(uv.x, uv.y)}) - centre_w;
  return {window.n_ab_w - slope, glm::cross(arm_x, window.n_ab_w) - glm::cross(arm_y, slope)};
}

}  // namespace asperity::detail
