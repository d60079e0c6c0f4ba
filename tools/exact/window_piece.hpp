// A piece of a textured surface as the window sees it, with bounds of its heights there.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "exact/chart_blocks.hpp"
#include "exact/texture_pyramid.hpp"
#include "window/height_lookup.hpp"

namespace asperity::detail {

/// A half plane across the window: the points where a u + b v + c >= 0.
struct half_plane {
  double a = 0.0, b = 0.0, c = 0.0;
  [[nodiscard]] double at(const vec2& uv) const noexcept { return a * uv.x + b * uv.y + c; }
};

/// Part of a textured surface: what a coarse triangle shows of a square of the texture.
struct surface_part {
  std::uint32_t slot = 0;  ///< index in patch_projection::triangles()
  texture_place at;
};

/// A body in the search for the deepest line: all that says where its surface is.
///
/// The surface over coarse triangle t is the textured one at the texel positions of t's chart. With the exact parallax
/// a point lies over its own (u, v); but where the patch ends, the surface does not go on across the lines of its last
/// edges in the window, and parts that turn their other side to the window do not count. With the paper's lookup a
/// point lies over its coarse point.
struct searched_body {
  const body_view& view;
  const texture_pyramid& pyramid;
  const chart_blocks& charts;
  parallax_mode parallax;

  static constexpr double rounding_texels = 1e-9;

  [[nodiscard]] bool over_itself() const noexcept { return parallax == parallax_mode::exact; }
  [[nodiscard]] const projected_triangle& triangle(std::uint32_t slot) const noexcept {
    return view.patch.triangles()[slot];
  }
  [[nodiscard]] const texel_triangle& chart(std::uint32_t slot) const noexcept {
    return view.index.texels[triangle(slot).triangle];
  }
  /// Barycentric coordinate of the coarse triangle over the window.
  [[nodiscard]] half_plane coarse_side(std::uint32_t slot, std::size_t corner) const noexcept {
    const projected_triangle& t = triangle(slot);
    const vec3& w = chart(slot).weight[corner];
    return {w.y * t.texel_x.per_u + w.z * t.texel_y.per_u, w.y * t.texel_x.per_v + w.z * t.texel_y.per_v,
            w.x + w.y * t.texel_x.at_centre + w.z * t.texel_y.at_centre};
  }

  /// Calls use(side) for every line across the window at which the surface over a triangle ends: where the patch ends,
  /// at its own edges and at those of its neighbours that do not cut into the triangle itself.
  template <class Use>
  void for_each_border(std::uint32_t slot, Use use) const noexcept {
    if (!over_itself()) return;
    const auto side = [&](std::uint32_t of, std::size_t corner) {
      half_plane s = coarse_side(of, corner);
      s.c += rounding_texels / chart(of).altitude[corner];
      return s;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const projected_triangle* next = beyond(slot, k);
      if (next == nullptr) {
        use(side(slot, k));
        continue;
      }
      const auto other = static_cast<std::uint32_t>(next - view.patch.triangles().data());
      for (std::size_t m = 0; m < 3; ++m) {
        if (beyond(other, m) != nullptr) continue;
        const half_plane s = side(other, m);
        const auto& c = triangle(slot).corner;
        if (s.at(vec2(c[0])) >= 0.0 && s.at(vec2(c[1])) >= 0.0 && s.at(vec2(c[2])) >= 0.0) use(s);
      }
    }
  }

 private:
  /// The triangle across the edge opposite to a corner; null where the patch ends there.
  [[nodiscard]] const projected_triangle* beyond(std::uint32_t slot, std::size_t corner) const noexcept {
    return view.patch.find(view.index.neighbour[triangle(slot).triangle][(corner + 1) % 3]);
  }
};

/// Determinant of the texel position by (u, v) over a coarse triangle. Not zero: it faces the window.
[[nodiscard]] inline double texels_per_area(const projected_triangle& t) noexcept {
  return t.texel_x.per_u * t.texel_y.per_v - t.texel_x.per_v * t.texel_y.per_u;
}

/// A part of a surface as the window sees it. With w the way from the square's middle, in texels, each of its points is
/// centre + along_x w.x + along_y w.y + an error; the error of component i is at most spare[i]. Window coordinates,
/// metres.
struct window_piece {
  static constexpr std::size_t most_sides = 4 + 3 + 9;  ///< of the square, the chart, the patch's border

  vec3 centre, along_x, along_y;
  vec3 spare;
  vec3 low, high;            ///< box about all its points
  bool is_graph = false;     ///< heights can be given over (u, v): what follows holds
  vec2 slope{0.0};           ///< of its plane over the window
  double above_plane = 0.0;  ///< largest distance of a point from the plane, along the height
  mat3 to_texels{0.0};       ///< upper left 2 x 2: texel position from the square's middle by (u, v) from the centre
  std::array<half_plane, most_sides> side{};
  std::uint32_t sides = 0;

  /// Height of its plane over (u, v).
  [[nodiscard]] double plane(const vec2& uv) const noexcept {
    return centre.z + slope.x * (uv.x - centre.x) + slope.y * (uv.y - centre.y);
  }
};

/// Describes a piece. @return false where no point of the surface is in it   @rt safe
[[nodiscard]] inline bool make_piece(const searched_body& body, const surface_part& part, window_piece& out) noexcept {
  const std::uint32_t slot = part.slot;
  const texture_place& at = part.at;
  const projected_triangle& t = body.triangle(slot);
  const texel_triangle& chart = body.chart(slot);
  const vec2 middle = at.middle();
  const double half = at.half();

  // Sides of the chart that cross the square, or leave nothing of it.
  struct cut {
    double at_middle, per_x, per_y;
  };
  std::array<cut, 3> cuts{};
  std::size_t cut_count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const vec3& w = chart.weight[k];
    const double reach = (std::fabs(w.y) + std::fabs(w.z)) * half;
    const double here = w.x + w.y * middle.x + w.z * middle.y + searched_body::rounding_texels / chart.altitude[k];
    if (here + reach < 0.0) return false;
    if (here - reach < 0.0) cuts[cut_count++] = {here, w.y, w.z};
  }

  texture_block block = body.pyramid.block(at);
  if (block.empty) return false;
  if (!block.one_cell) {
    const texture_block whole_chart = body.charts.block(t.triangle, middle);
    if (whole_chart.empty) return false;
    const auto size = [](const vec3& spare) { return spare.x + spare.y + spare.z; };
    if (size(whole_chart.spare) < size(block.spare)) block = whole_chart;
  }
  const window_map& map = body.view.map;
  out.centre = map.point(block.centre);
  out.along_x = map.direction(block.along_x);
  out.along_y = map.direction(block.along_y);
  vec3 twist(0.0);
  if (block.one_cell) {
    twist = map.direction(block.spare);
    out.spare = glm::abs(twist);
  } else {
    const auto reach = [&](const vec3& axis) { return glm::dot(glm::abs(axis), block.spare); };
    out.spare = {reach(map.u_b), reach(map.v_b), reach(map.n_b)};
  }
  if (!body.over_itself()) {  // over the coarse point, which is affine in the texel position
    const double det = texels_per_area(t);
    const vec2 x = vec2(t.texel_y.per_v, -t.texel_y.per_u) / det, y = vec2(-t.texel_x.per_v, t.texel_x.per_u) / det;
    const vec2 uv = (middle.x - t.texel_x.at_centre) * x + (middle.y - t.texel_y.at_centre) * y;
    out.centre = {uv.x, uv.y, out.centre.z};
    out.along_x = {x.x, x.y, out.along_x.z};
    out.along_y = {y.x, y.y, out.along_y.z};
    twist = {0.0, 0.0, twist.z};
    out.spare = {0.0, 0.0, out.spare.z};
  }
  constexpr double rounding_m = 1e-14;
  out.spare += rounding_m;
  const vec3 reach = half * (glm::abs(out.along_x) + glm::abs(out.along_y)) + out.spare;
  out.low = out.centre - reach;
  out.high = out.centre + reach;

  const double det = out.along_x.x * out.along_y.y - out.along_x.y * out.along_y.x;
  if (block.one_cell && body.over_itself()) {
    // The determinant is affine over a cell. twist is that of a full square of half size `half`.
    const vec2 w = vec2(twist) / (half * half);
    const double by_x = half * (out.along_x.x * w.y - out.along_x.y * w.x);
    const double by_y = half * (w.x * out.along_y.y - w.y * out.along_y.x);
    const double towards = texels_per_area(t) > 0.0 ? det : -det;
    if (towards + std::fabs(by_x) + std::fabs(by_y) <= 0.0) return false;  // all of it turned away
  }

  out.sides = 0;
  bool outside = false;
  body.for_each_border(slot, [&](const half_plane& s) {
    const double at_middle = s.at(vec2(out.centre)), over_box = std::fabs(s.a) * reach.x + std::fabs(s.b) * reach.y;
    outside = outside || at_middle + over_box < 0.0;
    if (at_middle - over_box < 0.0) out.side[out.sides++] = s;
  });
  if (outside) return false;

  const double x_length = std::fabs(out.along_x.x) + std::fabs(out.along_x.y);
  const double y_length = std::fabs(out.along_y.x) + std::fabs(out.along_y.y);
  out.is_graph = std::fabs(det) > 1e-4 * x_length * y_length && std::fabs(det) > 0.0;
  if (!out.is_graph) return true;
  const vec2 x_by_uv = vec2(out.along_y.y, -out.along_y.x) / det, y_by_uv = vec2(-out.along_x.y, out.along_x.x) / det;
  out.to_texels = mat3(x_by_uv.x, y_by_uv.x, 0.0, x_by_uv.y, y_by_uv.y, 0.0, 0.0, 0.0, 0.0);
  out.slope = out.along_x.z * x_by_uv + out.along_y.z * y_by_uv;
  out.above_plane = rounding_m + (block.one_cell ? std::fabs(twist.z - glm::dot(out.slope, vec2(twist)))
                                                 : out.spare.z + glm::dot(glm::abs(out.slope), vec2(out.spare)));
  // Inside the square, and on the inner side of the chart's edges: affine in the texel position, so in (u, v) up to
  // what the spare moves.
  const auto add = [&](double here, const vec2& by_uv) {
    const double moved = std::fabs(by_uv.x) * out.spare.x + std::fabs(by_uv.y) * out.spare.y;
    out.side[out.sides++] = {by_uv.x, by_uv.y, here + moved - glm::dot(by_uv, vec2(out.centre))};
  };
  for (const vec2& by_uv : {x_by_uv, y_by_uv}) {
    add(half, by_uv);
    add(half, -by_uv);
  }
  for (std::size_t i = 0; i < cut_count; ++i) {
    add(cuts[i].at_middle, cuts[i].per_x * x_by_uv + cuts[i].per_y * y_by_uv);
  }
  return true;
}

/// A point of the surface over (u, v).
struct surface_hit {
  bool found = false;
  double height = 0.0;  ///< m
  vec2 texel{0.0};
};

/// Reads the surface of one coarse triangle over (u, v), from a texel position near by.
/// @rt safe
[[nodiscard]] inline surface_hit read_surface(const searched_body& body, const surface_part& part, const vec2& uv,
                                              const vec2& start, double tolerance_m) noexcept {
  const std::uint32_t slot = part.slot;
  const projected_triangle& t = body.triangle(slot);
  const texel_triangle& chart = body.chart(slot);
  const auto inside = [&](const vec2& z) {
    const vec3 bary = chart.barycentric(z);
    for (std::size_t k = 0; k < 3; ++k) {
      const double reach = searched_body::rounding_texels / chart.altitude[k];
      if (bary[static_cast<int>(k)] < -reach) return false;
    }
    bool within = true;
    body.for_each_border(slot, [&](const half_plane& s) { within = within && s.at(uv) >= 0.0; });
    return within;
  };
  if (!body.over_itself()) {
    const vec2 z(t.texel_x(uv.x, uv.y), t.texel_y(uv.x, uv.y));
    if (!inside(z)) return {};
    const fine_hit f = look_beside(body.view, t, uv);
    return {f.kind != hit::none, f.height, z};
  }
  const double towards = texels_per_area(t) > 0.0 ? 1.0 : -1.0;
  vec2 z = start;
  for (int step = 0; step < 12; ++step) {
    const auto [q, dx, dy] = texture_cell(body.view.texture, z).seen_by(body.view.map).at(z);
    const double det = dx.x * dy.y - dx.y * dy.x;
    if (!is_finite(q) || !(det * towards > 0.0)) return {};
    const vec2 miss(uv.x - q.x, uv.y - q.y);
    const vec2 dz = vec2(dy.y * miss.x - dy.x * miss.y, dx.x * miss.y - dx.y * miss.x) / det;
    if (std::fabs(miss.x) <= tolerance_m && std::fabs(miss.y) <= tolerance_m) {
      if (!inside(z)) return {};
      return {true, q.z + dx.z * dz.x + dy.z * dz.y, z};
    }
    z += dz;
    if (!(std::fabs(z.x - start.x) + std::fabs(z.y - start.y) < 8.0)) return {};
  }
  return {};
}

}  // namespace asperity::detail
