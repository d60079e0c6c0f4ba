// A convex piece in the form that the narrow phase works on.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/textured_model.hpp"
#include "window/mesh_features.hpp"

namespace asperity {

/// A unique normal of the coarse triangles that a piece covers, and how far the piece reaches along it.
struct shape_face {
  vec3 normal{0.0};     ///< outward, unit
  double offset = 0.0;  ///< largest normal . vertex, metres
};

/// A convex edge of the coarse mesh beside a piece. Real directions out of it lie between its two faces' normals.
struct shape_edge {
  vec3 point{0.0};                ///< one end
  vec3 direction{0.0};            ///< unit
  std::array<vec3, 2> in_face{};  ///< unit, away from the edge into either face
};

/// Hull vertices of one piece with the real surface around them. Body frame, metres.
///
/// A piece is the hull of a patch of surface: part of its hull lies inside the body and is not surface. The hull
/// therefore serves for distances only. Directions to push along come from the coarse mesh: normals of covered
/// triangles, and cones of its convex edges and vertices, neighbours in other pieces included. A flat piece has one
/// normal.
struct convex_shape {
  std::vector<double> x, y, z;  ///< vertices, one array per coordinate
  std::vector<shape_face> faces;
  std::vector<shape_edge> edges;
  std::vector<vec3> vertex_normals;  ///< one per vertex: mean normal of the mesh there
  std::vector<vec3> outgoing;        ///< unit directions to the mesh neighbours of vertex i: fan[i] .. fan[i + 1]
  std::vector<std::uint32_t> fan;
  bounds box;
  vec3 centre{0.0};     ///< of the bounding sphere
  double radius = 0.0;  ///< of the bounding sphere, metres
  bool flat = false;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(x, y, z, faces, edges, vertex_normals, outgoing, fan);
  }
  /// @pre i < size()
  [[nodiscard]] vec3 vertex(std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }

  /// The vertex that lies furthest along d; the first of equals.
  /// @pre size() > 0   @rt safe
  [[nodiscard]] std::uint32_t support(const vec3& d) const noexcept {
    std::size_t best = 0;
    double furthest = d.x * x[0] + d.y * y[0] + d.z * z[0];
    for (std::size_t i = 1; i < x.size(); ++i) {
      const double s = d.x * x[i] + d.y * y[i] + d.z * z[i];
      if (s > furthest) {
        furthest = s;
        best = i;
      }
    }
    return static_cast<std::uint32_t>(best);
  }

  /// True where d, unit, points into the body behind every covered triangle.
  /// @rt safe
  [[nodiscard]] bool looks_away(const vec3& d) const noexcept {
    constexpr double grazing = 0.1;  // sine between facing and not facing; science, section 2
    return std::all_of(faces.begin(), faces.end(),
                       [&](const shape_face& f) { return glm::dot(f.normal, d) < -grazing; });
  }
};

/// How far the unit direction d is a direction of a shape's real surface: 1 where it lies in the normal cone of a face,
/// a convex edge or a vertex of the coarse mesh, falling to 0 where it is `slack` (a sine) outside all of them.
/// It falls smoothly, so that a pair whose direction leaves the real surface's loses its weight without a jump.
/// @pre slack > 0   @rt safe
[[nodiscard]] inline double normal_cone_share(const convex_shape& shape, const vec3& d, double slack) noexcept {
  double violation = slack;
  for (const shape_face& f : shape.faces) {
    const double along = glm::dot(f.normal, d);
    if (along <= 0.0) continue;
    const vec3 across = d - along * f.normal;
    violation = std::min(violation, std::sqrt(glm::dot(across, across)));
  }
  for (const shape_edge& e : shape.edges) {
    if (violation <= 0.0) break;
    // The bisector on the outside is opposite to the sum of the in-face directions: its sign separates out from in.
    if (glm::dot(e.in_face[0] + e.in_face[1], d) > 0.0) continue;
    const double out = std::max(glm::dot(e.in_face[0], d), glm::dot(e.in_face[1], d));
    violation = std::min(violation, std::max({0.0, out, std::fabs(glm::dot(e.direction, d))}));
  }
  for (std::size_t i = 0; i < shape.size() && violation > 0.0; ++i) {
    if (glm::dot(shape.vertex_normals[i], d) <= 0.0) continue;
    double out = 0.0;
    for (std::size_t k = shape.fan[i]; k < shape.fan[i + 1] && out < violation; ++k) {
      out = std::max(out, glm::dot(shape.outgoing[k], d));
    }
    violation = std::min(violation, out);
  }
  return smoothstep(1.0 - violation / slack);
}

/// The shape of a piece. Offline: allocates.
/// @pre the piece has at least one vertex and covers at least one triangle of the mesh that `features` belong to
[[nodiscard]] inline convex_shape make_convex_shape(const coarse_mesh& mesh, const mesh_features& features,
                                                    const convex_piece& piece) {
  constexpr double same_normal = 1.0 - 1e-12;

  convex_shape s;
  s.flat = piece.flat;
  s.box = {piece.vertices.front(), piece.vertices.front()};
  for (const vec3& p : piece.vertices) {
    s.x.push_back(p.x);
    s.y.push_back(p.y);
    s.z.push_back(p.z);
    s.box = {glm::min(s.box.low, p), glm::max(s.box.high, p)};
  }
  s.centre = 0.5 * (s.box.low + s.box.high);
  for (const vec3& p : piece.vertices) s.radius = std::max(s.radius, glm::distance(p, s.centre));

  for (const std::uint32_t t : piece.triangles) {
    const vec3 n = features.triangle_normals[t];
    if (n == vec3(0.0)) continue;
    const bool known = std::any_of(s.faces.begin(), s.faces.end(),
                                   [&](const shape_face& f) { return glm::dot(f.normal, n) > same_normal; });
    if (!known) s.faces.push_back({n, glm::dot(n, s.vertex(s.support(n)))});
  }

  std::vector<std::uint32_t> covered = piece.triangles;
  std::sort(covered.begin(), covered.end());
  for (const mesh_edge& e : features.edges) {
    if (e.convex && (std::binary_search(covered.begin(), covered.end(), e.triangle[0]) ||
                     std::binary_search(covered.begin(), covered.end(), e.triangle[1]))) {
      s.edges.push_back({mesh.positions[e.vertex[0]], e.direction, e.in_face});
    }
  }

  // Hull vertices carry no index. Each is a corner of a covered triangle, up to rounding in a file.
  s.fan.push_back(0);
  for (const vec3& p : piece.vertices) {
    std::uint32_t nearest = mesh.triangles[piece.triangles.front()].vertex[0];
    for (const std::uint32_t t : piece.triangles) {
      for (const std::uint32_t v : mesh.triangles[t].vertex) {
        if (glm::distance(p, mesh.positions[v]) < glm::distance(p, mesh.positions[nearest])) nearest = v;
      }
    }
    s.vertex_normals.push_back(features.vertex_normals[nearest]);
    for (const std::uint32_t v : features.neighbours[nearest]) {
      s.outgoing.push_back(detail::unit_or_zero(mesh.positions[v] - mesh.positions[nearest]));
    }
    s.fan.push_back(static_cast<std::uint32_t>(s.outgoing.size()));
  }
  return s;
}

}  // namespace asperity
