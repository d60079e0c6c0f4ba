// Directions in which two overlapping shapes can be pushed apart, by separating axes of their real surfaces.
#pragma once

#include <cstddef>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "window/convex_shape.hpp"
#include "window/gjk.hpp"

namespace asperity {

/// A direction and the separation along it: the least n . (b - a) over both shapes; negative where they overlap.
struct separating_direction {
  vec3 n_ab{0.0};  ///< unit, from A to B, frame of A
  double separation_m = 0.0;
};

/// The most promising directions, largest separation (least depth) first.
using separating_directions = fixed_vector<separating_direction, 16>;

/// Separation of the two shapes along the unit direction n (frame of A).
/// @rt safe
[[nodiscard]] inline double separation_along(const convex_shape& A, const convex_shape& B, const placement& T_ab,
                                             const vec3& n) noexcept {
  return glm::dot(n, T_ab * B.vertex(B.support(T_ab.to_local(-n)))) - glm::dot(n, A.vertex(A.support(n)));
}

namespace detail {

inline void insert_by_separation(separating_directions& list, const separating_direction& d) noexcept {
  if (list.full()) {
    if (d.separation_m <= list.back().separation_m) return;
    list.truncate(list.size() - 1);
  }
  (void)list.push_back(d);
  for (std::size_t i = list.size() - 1; i > 0 && list[i].separation_m > list[i - 1].separation_m; --i) {
    std::swap(list[i], list[i - 1]);
  }
}

}  // namespace detail

/// Directions from A to B by rising depth: the face normals of A, the reversed face normals of B, and the cross
/// products of two convex edges where they lie between both edges' face normals. Only real surface counts: an
/// artificial face of a hull gives no direction, a flat piece pushes along its outward side alone.
/// For two bodies that are convex as a whole the first entry is the exact penetration depth.
/// @rt safe: cost grows with edges of A times edges of B
/// @source Minkowski difference's faces are A's, B's or spanned by two edges whose Gauss arcs cross
inline void find_separating_directions(const convex_shape& A, const convex_shape& B, const placement& T_ab,
                                       separating_directions& out) noexcept {
  constexpr double parallel_sine = 1e-7;
  constexpr double arc_slack = 1e-9;

  out.clear();
  for (const shape_face& f : A.faces) {
    const double b = glm::dot(f.normal, T_ab * B.vertex(B.support(T_ab.to_local(-f.normal))));
    detail::insert_by_separation(out, {f.normal, b - f.offset});
  }
  for (const shape_face& f : B.faces) {
    const vec3 n = -(T_ab.rotation * f.normal);
    const double b = glm::dot(n, T_ab.position) - f.offset;
    detail::insert_by_separation(out, {n, b - glm::dot(n, A.vertex(A.support(n)))});
  }
  for (const shape_edge& eb : B.edges) {
    const vec3 direction = T_ab.rotation * eb.direction;
    const vec3 point = T_ab * eb.point;
    const vec3 in_0 = T_ab.rotation * eb.in_face[0];
    const vec3 in_1 = T_ab.rotation * eb.in_face[1];
    for (const shape_edge& ea : A.edges) {
      vec3 n = glm::cross(ea.direction, direction);
      const double sine = std::sqrt(glm::dot(n, n));
      if (sine < parallel_sine) continue;
      n /= glm::dot(ea.in_face[0] + ea.in_face[1], n) > 0.0 ? -sine : sine;
      if (glm::dot(ea.in_face[0], n) > arc_slack || glm::dot(ea.in_face[1], n) > arc_slack ||
          glm::dot(in_0, n) < -arc_slack || glm::dot(in_1, n) < -arc_slack) {
        continue;
      }
      if (out.full() && glm::dot(n, point - ea.point) <= out.back().separation_m) continue;
      detail::insert_by_separation(out, {n, separation_along(A, B, T_ab, n)});
    }
  }
}

}  // namespace asperity
