// Normals, edges and vertex fans of a coarse mesh. They decide whether a direction belongs to its real surface.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/coarse_mesh.hpp"

namespace asperity {

/// An edge of the coarse mesh. In-face directions are unit, orthogonal to the edge, and point away from it into the
/// face.
struct mesh_edge {
  std::array<std::uint32_t, 2> vertex{};
  std::array<std::uint32_t, 2> triangle{};  ///< both triangles; the same one twice on an open border
  vec3 direction{0.0};                      ///< unit
  std::array<vec3, 2> in_face{};            ///< one per triangle
  bool convex = false;                      ///< the solid lies inside the smaller angle (flat edges are not convex)
};

/// Local shape of a coarse mesh, body frame. Triangles without area have a zero normal and no edges.
struct mesh_features {
  std::vector<vec3> triangle_normals;                  ///< outward, unit, or zero
  std::vector<mesh_edge> edges;                        ///< in the order of their sorted vertex indices
  std::vector<vec3> vertex_normals;                    ///< unit mean of the incident triangles, weighted by area
  std::vector<std::vector<std::uint32_t>> neighbours;  ///< vertices joined to a vertex by an edge
};

namespace detail {

struct half_edge {
  std::uint32_t low = 0, high = 0, triangle = 0, opposite = 0;
};

inline vec3 unit_or_zero(const vec3& v) noexcept {
  const double length = std::sqrt(glm::dot(v, v));
  return length > 0.0 ? v / length : vec3(0.0);
}

}  // namespace detail

/// Features of a mesh. Offline: allocates.
[[nodiscard]] inline mesh_features make_mesh_features(const coarse_mesh& mesh) {
  // Below this sine of the angle between two faces an edge is flat: the faces' own normals cover its directions.
  constexpr double flat_sine = 1e-6;

  mesh_features out;
  out.vertex_normals.assign(mesh.positions.size(), vec3(0.0));
  out.neighbours.resize(mesh.positions.size());
  std::vector<detail::half_edge> halves;
  halves.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const vec3 area = area_normal(corners(mesh, t));
    const vec3 normal = detail::unit_or_zero(area);
    out.triangle_normals.push_back(normal);
    if (normal == vec3(0.0)) continue;
    const auto& v = mesh.triangles[t].vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      out.vertex_normals[v[k]] += area;
      const std::uint32_t a = v[k];
      const std::uint32_t b = v[(k + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), v[(k + 2) % 3]});
    }
  }
  for (vec3& n : out.vertex_normals) n = detail::unit_or_zero(n);

  std::sort(halves.begin(), halves.end(), [](const detail::half_edge& a, const detail::half_edge& b) {
    return a.low != b.low ? a.low < b.low : (a.high != b.high ? a.high < b.high : a.triangle < b.triangle);
  });
  for (std::size_t i = 0; i < halves.size();) {
    const detail::half_edge& first = halves[i];
    const bool paired = i + 1 < halves.size() && halves[i + 1].low == first.low && halves[i + 1].high == first.high;
    const detail::half_edge& second = paired ? halves[i + 1] : first;
    mesh_edge e;
    e.vertex = {first.low, first.high};
    e.triangle = {first.triangle, second.triangle};
    const vec3 origin = mesh.positions[first.low];
    e.direction = detail::unit_or_zero(mesh.positions[first.high] - origin);
    const auto in_face = [&](std::uint32_t opposite) {
      const vec3 d = mesh.positions[opposite] - origin;
      return detail::unit_or_zero(d - glm::dot(d, e.direction) * e.direction);
    };
    e.in_face = {in_face(first.opposite), in_face(second.opposite)};
    e.convex = !paired || glm::dot(e.in_face[1], out.triangle_normals[first.triangle]) < -flat_sine;
    out.edges.push_back(e);
    out.neighbours[first.low].push_back(first.high);
    out.neighbours[first.high].push_back(first.low);
    i += paired ? 2 : 1;
  }
  return out;
}

}  // namespace asperity
