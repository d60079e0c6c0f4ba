// The model check: what must be true of a textured model before a tick may rely on it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// Largest magnitude of a coordinate in a model, metres. More than this is a wrong unit or a broken file.
inline constexpr double max_coordinate_m = 1e4;
/// Largest number of triangles of a coarse mesh. A tick reads some hundred; the limit bounds memory and checks.
inline constexpr std::size_t max_coarse_triangles = 1'000'000;

namespace detail {

inline std::string vertex_name(std::size_t v) { return "vertex " + std::to_string(v); }
inline std::string triangle_name(std::size_t t) { return "coarse triangle " + std::to_string(t); }

inline bool is_usable(const vec3& p) noexcept {
  const vec3 a = glm::abs(p);
  return a.x <= max_coordinate_m && a.y <= max_coordinate_m && a.z <= max_coordinate_m;  // false for NaN
}

/// Indices, coordinates and areas. Comes first: the other checks use indices that this one has checked.
inline result<void> check_triangles(const coarse_mesh& mesh) {
  if (mesh.triangles.size() < 4) {
    return error{error_code::bad_mesh, "the coarse mesh has " + std::to_string(mesh.triangles.size()) +
                                           " triangles, but no closed surface has fewer than 4; bake it again"};
  }
  if (mesh.triangles.size() > max_coarse_triangles) {
    return error{error_code::limit_exceeded, "the coarse mesh has " + std::to_string(mesh.triangles.size()) +
                                                 " triangles, more than the limit of " +
                                                 std::to_string(max_coarse_triangles) + "; bake it with fewer"};
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (!is_usable(mesh.positions[v])) {
      return error{error_code::bad_mesh, vertex_name(v) +
                                             " of the coarse mesh has a coordinate that is not finite or " +
                                             "beyond 10 km; check the unit (metres) and bake again"};
    }
  }
  std::vector<bool> used(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t].vertex) {
      if (v >= mesh.positions.size()) {
        return error{error_code::bad_mesh, triangle_name(t) + " names vertex " + std::to_string(v) + " of " +
                                               std::to_string(mesh.positions.size()) + "; bake the model again"};
      }
      used[v] = true;
    }
    const auto c = corners(mesh, t);
    const auto squared = [](const vec3& e) { return glm::dot(e, e); };
    const double longest = std::max({squared(c[1] - c[0]), squared(c[2] - c[1]), squared(c[0] - c[2])});
    const vec3 n = area_normal(c);
    // Below this the normal is rounding noise: the height is under 1e-10 of the longest edge.
    if (!(std::sqrt(squared(n)) > 1e-10 * longest)) {
      return error{error_code::bad_mesh,
                   triangle_name(t) + " has no area; remove it from the coarse mesh and bake again"};
    }
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) {
      return error{error_code::bad_mesh, vertex_name(v) + " of the coarse mesh belongs to no triangle; remove it"};
    }
  }
  return {};
}

/// Closed and consistently oriented: every edge is used once in each direction.
inline result<void> check_closed(const coarse_mesh& mesh) {
  struct directed_edge {
    std::uint32_t low, high, triangle;
    bool forward;
  };
  std::vector<directed_edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t].vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k];
      const std::uint32_t b = v[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const directed_edge& a, const directed_edge& b) {
    return std::pair(a.low, a.high) != std::pair(b.low, b.high) ? std::pair(a.low, a.high) < std::pair(b.low, b.high)
                                                                : a.triangle < b.triangle;
  });
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    const std::string edge = "the edge between vertices " + std::to_string(edges[i].low) + " and " +
                             std::to_string(edges[i].high) + " at " + triangle_name(edges[i].triangle);
    if (end - i == 1) {
      return error{error_code::bad_mesh, edge + " is open; close the coarse mesh and bake again"};
    }
    if (end - i > 2) {
      return error{error_code::bad_mesh, edge + " is shared by " + std::to_string(end - i) +
                                             " triangles instead of 2; make the coarse mesh 2-manifold and bake again"};
    }
    if (edges[i].forward == edges[i + 1].forward) {
      return error{error_code::bad_mesh,
                   edge + " has the same direction in both of its triangles; orient the coarse mesh and bake again"};
    }
    i = end;
  }
  if (!(compute_mass_properties(mesh).volume_m3 > 0.0)) {
    return error{error_code::bad_mesh,
                 "the coarse mesh is inside out (its volume is not positive); flip its triangles"};
  }
  return {};
}

/// The triangles around a vertex form one fan. Where the surface touched itself in a single point, inside and outside
/// could not be told apart there. @pre check_closed() passed
inline result<void> check_fans(const coarse_mesh& mesh) {
  // A corner is where a triangle leaves a vertex along an edge. The corner after it, counter-clockwise, leaves along
  // the edge by which the triangle comes back. Where more than one cycle of corners has the same vertex, fans touch.
  struct corner {
    std::uint32_t from, to, back;
  };
  const auto before = [](const corner& a, const corner& b) {
    return std::pair(a.from, a.to) < std::pair(b.from, b.to);
  };
  std::vector<corner> around;
  around.reserve(3 * mesh.triangles.size());
  for (const coarse_triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      around.push_back({t.vertex[k], t.vertex[(k + 1) % 3], t.vertex[(k + 2) % 3]});
    }
  }
  std::sort(around.begin(), around.end(), before);
  for (std::size_t first = 0; first < around.size();) {
    const std::uint32_t v = around[first].from;
    std::size_t corners = 1;
    while (first + corners < around.size() && around[first + corners].from == v) ++corners;
    const auto begin = around.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = begin + static_cast<std::ptrdiff_t>(corners);
    std::size_t in_fan = 0;
    auto at = begin;
    do {
      at = std::lower_bound(begin, end, corner{v, at->back, 0}, before);
      ++in_fan;
    } while (at != begin);
    if (in_fan != corners) {
      return error{error_code::bad_mesh, vertex_name(v) +
                                             " of the coarse mesh joins surfaces that touch only there; split it into "
                                             "one vertex for each and bake again"};
    }
    first += corners;
  }
  return {};
}

/// Texture coordinates: inside the image, with area, and without overlap as far as areas can tell.
inline result<void> check_charts(const coarse_mesh& mesh) {
  double covered = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& uv = mesh.triangles[t].uv;
    for (const vec2& p : uv) {
      if (!(p.x >= 0.0 && p.x <= 1.0 && p.y >= 0.0 && p.y <= 1.0)) {
        return error{error_code::bad_texture,
                     triangle_name(t) + " has a texture coordinate outside [0, 1]; bake the model again"};
      }
    }
    const vec2 a = uv[1] - uv[0];
    const vec2 b = uv[2] - uv[0];
    const double area = 0.5 * std::fabs(a.x * b.y - a.y * b.x);
    if (!(area > 0.0)) {
      return error{error_code::bad_texture, triangle_name(t) + " has no area in the texture; bake the model again"};
    }
    covered += area;
  }
  if (covered > 1.0 + 1e-6) {
    // A texel is one position in space, so two places of the surface cannot share it.
    return error{error_code::bad_texture, "the charts cover " + std::to_string(covered) +
                                              " times the texture, so some overlap; bake the model again"};
  }
  return {};
}

/// Columns of the texels that a bilinear lookup inside a triangle can touch, row by row.
/// Exact but for a margin of a thousandth of a texel, which covers lookups in single precision.
class chart_footprint {
 public:
  struct range {
    std::uint32_t first, last;
  };

  chart_footprint(const haptic_texture& texture, const std::array<vec2, 3>& uv) noexcept
      : width_(texture.width), height_(texture.height) {
    for (std::size_t k = 0; k < 3; ++k) {  // in units of texels, whole numbers at texel centres, as in sample()
      corner_[k] = {uv[k].x * width_ - 0.5, uv[k].y * height_ - 0.5};
    }
  }

  [[nodiscard]] range rows() const noexcept {
    return touched(std::min({corner_[0].y, corner_[1].y, corner_[2].y}),
                   std::max({corner_[0].y, corner_[1].y, corner_[2].y}), height_);
  }

  /// Columns of row j that are touched; first > last where there are none.
  [[nodiscard]] range columns(std::uint32_t j) const noexcept {
    // Row j serves lookups with y in (j - 1, j + 1); lookups below the first row are clamped to it, with row 1 beside
    // it.
    const double low = j <= 1 ? -1.0 : j - 1.0 - margin;
    const double high = j + 1.0 + margin;
    double left = 1e300;
    double right = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      const vec2 p = corner_[k];
      const vec2 q = corner_[(k + 1) % 3];
      if (std::max(p.y, q.y) < low || std::min(p.y, q.y) > high) continue;
      const auto at = [&](double y) { return p.y == q.y ? p.x : p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x); };
      const double a = p.y < low || p.y > high ? at(p.y < low ? low : high) : p.x;
      const double b = q.y < low || q.y > high ? at(q.y < low ? low : high) : q.x;
      left = std::min({left, a, b});
      right = std::max({right, a, b});
    }
    if (left > right) return {1, 0};
    return touched(left, right, width_);
  }

 private:
  static constexpr double margin = 1e-3;

  /// Texels whose support meets [low, high] along one axis.
  static range touched(double low, double high, std::uint32_t size) noexcept {
    const double first = std::clamp(std::ceil(low - 1.0 - margin), 0.0, size - 1.0);
    const double last = std::clamp(std::max(std::floor(high + 1.0 + margin), 1.0), 0.0, size - 1.0);
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
  }

  std::uint32_t width_;
  std::uint32_t height_;
  std::array<vec2, 3> corner_;
};

/// Every texel that a lookup can touch holds a position. @pre check_charts() passed
inline result<void> check_texels(const textured_model& model) {
  const haptic_texture& texture = model.texture;
  constexpr std::uint32_t max_side = 16384;
  if (texture.width == 0 || texture.height == 0 || texture.width > max_side || texture.height > max_side ||
      texture.texels.size() != static_cast<std::size_t>(texture.width) * texture.height) {
    return error{error_code::bad_texture, "the haptic texture holds " + std::to_string(texture.texels.size()) +
                                              " texels for a declared size of " + std::to_string(texture.width) +
                                              " x " + std::to_string(texture.height) +
                                              " (1 to 16384 each); bake it again"};
  }
  // Charts that do not overlap touch each texel a few times; needle-shaped ones beyond this are not a real atlas.
  std::size_t budget = 16 * texture.texels.size() + 64 * model.mesh.triangles.size();
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const chart_footprint footprint(texture, model.mesh.triangles[t].uv);
    const auto rows = footprint.rows();
    for (std::uint32_t j = rows.first; j <= rows.last; ++j) {
      const auto columns = footprint.columns(j);
      if (columns.first > columns.last) continue;
      const std::size_t count = columns.last - columns.first + 1;
      if (count > budget) {
        return error{error_code::bad_texture, "the charts up to " + triangle_name(t) +
                                                  " are needles that cross the texture over and over; bake it again"};
      }
      budget -= count;
      for (std::uint32_t i = columns.first; i <= columns.last; ++i) {
        if (!is_usable(texture.at(i, j))) {
          return error{error_code::bad_texture,
                       "texel (" + std::to_string(i) + ", " + std::to_string(j) + ") under " + triangle_name(t) +
                           " is not a position (NaN, infinite or beyond 10 km); bake the model again"};
        }
      }
    }
  }
  return {};
}

/// Every coarse triangle in exactly one piece; every index of a hull in range.
inline result<void> check_pieces(const textured_model& model) {
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> owner(model.mesh.triangles.size(), none);
  for (std::size_t k = 0; k < model.pieces.size(); ++k) {
    const convex_piece& piece = model.pieces[k];
    const std::string name = "convex piece " + std::to_string(k);
    if (piece.triangles.empty() || piece.hull.empty()) {
      return error{error_code::bad_mesh, name + " is empty; bake the model again"};
    }
    for (const vec3& p : piece.vertices) {
      if (!is_usable(p)) return error{error_code::bad_mesh, name + " has a vertex that is not finite; bake again"};
    }
    for (const auto& face : piece.hull) {
      for (const std::uint32_t v : face) {
        if (v >= piece.vertices.size()) {
          return error{error_code::bad_mesh, name + " has a hull face that names vertex " + std::to_string(v) + " of " +
                                                 std::to_string(piece.vertices.size()) + "; bake the model again"};
        }
      }
    }
    for (const std::uint32_t t : piece.triangles) {
      if (t >= owner.size()) {
        return error{error_code::bad_mesh, name + " covers " + triangle_name(t) + " of " +
                                               std::to_string(owner.size()) + "; bake the model again"};
      }
      if (owner[t] != none) {
        return error{error_code::bad_mesh, triangle_name(t) + " belongs to convex pieces " + std::to_string(owner[t]) +
                                               " and " + std::to_string(k) + "; bake the model again"};
      }
      owner[t] = k;
    }
  }
  const auto orphan = std::find(owner.begin(), owner.end(), none);
  if (orphan != owner.end()) {
    return error{error_code::bad_mesh, triangle_name(static_cast<std::size_t>(orphan - owner.begin())) +
                                           " belongs to no convex piece; bake the model again"};
  }
  return {};
}

}  // namespace detail

/// Checks everything that a tick relies on. Whoever makes a model by hand or by a tool calls this once before using it.
/// @return bad_mesh: indices, coordinates (finite, within 10 km), areas, closedness, orientation, one fan per vertex,
///         pieces;
///         limit_exceeded: more than max_coarse_triangles;
///         bad_texture: size, coordinates, a texel under a chart that holds no position, a map of materials that does not fit;
///         invalid_argument: a number of its materials. The message names the place.
[[nodiscard]] inline result<void> validate(const textured_model& model) {
  if (auto r = detail::check_triangles(model.mesh); !r) return r;
  if (auto r = detail::check_closed(model.mesh); !r) return r;
  if (auto r = detail::check_fans(model.mesh); !r) return r;
  if (auto r = detail::check_charts(model.mesh); !r) return r;
  if (auto r = detail::check_texels(model); !r) return r;
  if (auto r = detail::check_pieces(model); !r) return r;
  return check_materials(model);
}

}  // namespace asperity
