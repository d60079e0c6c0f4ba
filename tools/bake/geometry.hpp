// Small geometry that several stages of the bake share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/float32.hpp"
#include "asperity/core/math.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {

[[nodiscard]] inline std::array<vec3, 3> corners(std::span<const vec3> positions, const index_triangle& t) noexcept {
  return {positions[t[0]], positions[t[1]], positions[t[2]]};
}

/// The vector divided by its length; zero stays zero.
[[nodiscard]] inline vec3 normalised(const vec3& v) noexcept {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : v;
}

/// Unit normal of a triangle; zero for one without area.
[[nodiscard]] inline vec3 unit_normal(const std::array<vec3, 3>& c) noexcept { return normalised(area_normal(c)); }

/// A triangle has no area where its height is lost in the rounding of its coordinates. @param reach  the largest of them
[[nodiscard]] inline bool has_no_area(const std::array<vec3, 3>& c, double reach) noexcept {
  const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
  return glm::length(area_normal(c)) <= longest * reach * 1e-15;
}
/// An edge no longer than this share of the reach makes its triangles have no area.
inline constexpr double no_length_per_reach = 2e-15;

/// Angle at corner k, rad.
[[nodiscard]] inline double corner_angle(const std::array<vec3, 3>& c, std::size_t k) noexcept {
  const vec3 a = c[(k + 1) % 3] - c[k];
  const vec3 b = c[(k + 2) % 3] - c[k];
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The number as float32 stores it: a saved model must come back with the same bits.
[[nodiscard]] inline double to_float32(double x) noexcept { return asperity::round_to_float32(x); }
[[nodiscard]] inline vec3 to_float32(const vec3& v) noexcept { return asperity::round_to_float32(v); }

/// Point of the segment ab nearest to p.
[[nodiscard]] inline vec3 closest_on_segment(const vec3& p, const vec3& a, const vec3& b) noexcept {
  const vec3 d = b - a;
  const double length2 = glm::dot(d, d);
  const double s = length2 > 0.0 ? std::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0.0;
  return a + s * d;
}

/// Unit normals of the vertices: mean of the faces around, weighted by their angle at the vertex.
[[nodiscard]] inline std::vector<vec3> vertex_normals(std::span<const vec3> positions,
                                                      std::span<const index_triangle> triangles) {
  std::vector<vec3> normals(positions.size(), vec3(0.0));
  for (const index_triangle& t : triangles) {
    const auto c = corners(positions, t);
    const vec3 n = unit_normal(c);
    for (std::size_t k = 0; k < 3; ++k) normals[t[k]] += corner_angle(c, k) * n;
  }
  for (vec3& n : normals) n = normalised(n);
  return normals;
}

/// Removes the vertices that no triangle uses; the others keep their order. @pre indices in range
inline void drop_unused_vertices(triangle_mesh& mesh) {
  std::vector<std::uint32_t> number(mesh.positions.size(), no_halfedge);
  for (const index_triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) number[v] = 0;
  std::uint32_t used = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == no_halfedge) continue;
    mesh.positions[used] = mesh.positions[v];
    number[v] = used++;
  }
  mesh.positions.resize(used);
  for (index_triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
}

/// Shortest edge at each vertex that has a length, m; infinite at a vertex without one.
[[nodiscard]] inline std::vector<double> shortest_edges(const triangle_mesh& mesh) {
  std::vector<double> out(mesh.positions.size(), std::numeric_limits<double>::infinity());
  for (const index_triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      const double length = glm::length(mesh.positions[a] - mesh.positions[b]);
      if (!(length > 0.0)) continue;
      out[a] = std::min(out[a], length);
      out[b] = std::min(out[b], length);
    }
  return out;
}

}  // namespace asperity::bake
