// Distance between two convex shapes by the algorithm of Gilbert, Johnson and Keerthi, with a warm start.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "window/convex_shape.hpp"

namespace asperity {

/// Placement of shape B in the frame of shape A, as a matrix: a point costs nine products instead of a quaternion's.
struct placement {
  mat3 rotation{1.0};
  vec3 position{0.0};

  placement() = default;
  explicit placement(const pose& T) noexcept : rotation(glm::mat3_cast(T.rotation)), position(T.position) {}
  [[nodiscard]] vec3 operator*(const vec3& p) const noexcept { return rotation * p + position; }
  /// A direction of A's frame in B's.
  [[nodiscard]] vec3 to_local(const vec3& d) const noexcept { return d * rotation; }
};

/// Vertices that held the closest points last time. A wrong or stale one costs iterations, never correctness.
struct gjk_cache {
  std::uint32_t size = 0;
  std::array<std::uint32_t, 3> a{}, b{};
};

enum class gjk_outcome : std::uint8_t {
  separated,    ///< distance, points and direction are set
  beyond,       ///< further apart than the limit; nothing else is set
  overlapping,  ///< they share a point; distance is 0 and there is no direction
};

struct gjk_result {
  gjk_outcome outcome = gjk_outcome::overlapping;
  double distance = 0.0;    ///< metres
  vec3 p_a{0.0}, p_b{0.0};  ///< closest points, frame of A
  vec3 n_ab{0.0};           ///< unit, from A to B, frame of A
  std::uint32_t iterations = 0;
};

namespace detail {

/// A vertex of the difference A - B, the points it comes from, and its share of the closest point.
struct difference_vertex {
  vec3 w{0.0}, a{0.0}, b{0.0};
  std::uint32_t ia = 0, ib = 0;
  double share = 1.0;
};

struct simplex {
  std::array<difference_vertex, 4> v;
  std::size_t size = 0;

  [[nodiscard]] vec3 closest() const noexcept {
    vec3 p(0.0);
    for (std::size_t i = 0; i < size; ++i) p += v[i].share * v[i].w;
    return p;
  }
};

inline void keep_vertex(simplex& s, std::size_t i) noexcept {
  s.v[0] = s.v[i];
  s.v[0].share = 1.0;
  s.size = 1;
}

/// Shares j : i as towards_j : towards_i; both 0 where a stale cache made the two ends equal.
inline void keep_edge(simplex& s, std::size_t i, std::size_t j, double towards_j, double towards_i) noexcept {
  const double whole = towards_j + towards_i;
  const double share_j = whole > 0.0 ? towards_j / whole : 0.0;
  const difference_vertex second = s.v[j];
  s.v[0] = s.v[i];
  s.v[1] = second;
  s.v[0].share = 1.0 - share_j;
  s.v[1].share = share_j;
  s.size = 2;
}

/// Reduces a segment to the part that holds the point closest to the origin.
inline void reduce_segment(simplex& s) noexcept {
  const vec3 ab = s.v[1].w - s.v[0].w;
  const double t = -glm::dot(s.v[0].w, ab);
  const double length2 = glm::dot(ab, ab);
  if (t <= 0.0 || length2 <= 0.0) return keep_vertex(s, 0);
  if (t >= length2) return keep_vertex(s, 1);
  keep_edge(s, 0, 1, t, length2 - t);
}

/// The same for a triangle, by the signs of its barycentric coordinates.
inline void reduce_triangle(simplex& s) noexcept {
  const vec3 a = s.v[0].w;
  const vec3 b = s.v[1].w;
  const vec3 c = s.v[2].w;
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  const double ab_a = -glm::dot(ab, a), ac_a = -glm::dot(ac, a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return keep_vertex(s, 0);
  const double ab_b = -glm::dot(ab, b), ac_b = -glm::dot(ac, b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return keep_vertex(s, 1);
  const double area_c = ab_a * ac_b - ab_b * ac_a;
  if (area_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return keep_edge(s, 0, 1, ab_a, -ab_b);
  const double ab_c = -glm::dot(ab, c), ac_c = -glm::dot(ac, c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return keep_vertex(s, 2);
  const double area_b = ab_c * ac_a - ab_a * ac_c;
  if (area_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return keep_edge(s, 0, 2, ac_a, -ac_c);
  const double area_a = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b;
  const double from_c = ab_c - ac_c;
  if (area_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) return keep_edge(s, 1, 2, from_b, from_c);
  const double area = area_a + area_b + area_c;
  if (!(area > 0.0)) {  // three points in a line
    s.size = 2;
    return reduce_segment(s);
  }
  s.v[1].share = area_b / area;
  s.v[2].share = area_c / area;
  s.v[0].share = 1.0 - s.v[1].share - s.v[2].share;
  s.size = 3;
}

/// The same for a tetrahedron. @return true where it holds the origin; s is whole then
inline bool reduce_tetrahedron(simplex& s) noexcept {
  constexpr std::array<std::array<std::size_t, 4>, 4> faces{{{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}}};
  constexpr double flat = 1e-12;
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  simplex best;
  for (const auto& f : faces) {
    const vec3 a = s.v[f[0]].w;
    const vec3 normal = glm::cross(s.v[f[1]].w - a, s.v[f[2]].w - a);
    const vec3 to_fourth = s.v[f[3]].w - a;
    const double origin_side = -glm::dot(normal, a);
    const double fourth_side = glm::dot(normal, to_fourth);
    const bool degenerate =
        std::fabs(fourth_side) <= flat * std::sqrt(glm::dot(normal, normal) * glm::dot(to_fourth, to_fourth));
    if (origin_side * fourth_side >= 0.0 && !degenerate) continue;
    inside = false;
    simplex face;
    for (std::size_t i = 0; i < 3; ++i) face.v[i] = s.v[f[i]];
    face.size = 3;
    reduce_triangle(face);
    const vec3 p = face.closest();
    if (glm::dot(p, p) < nearest) {
      nearest = glm::dot(p, p);
      best = face;
    }
  }
  if (!inside) s = best;
  return inside;
}

}  // namespace detail

/// Distance between shapes A and B (B placed in A's frame); stops as soon as it is known to exceed `limit`.
/// The search starts from the cache and writes it for the next call; with a cache of size 0 it starts from nothing.
/// @param limit metres; infinity for the exact distance always
/// @pre the cache's indices belong to these shapes   @rt safe: at most 64 iterations, twice
[[nodiscard]] inline gjk_result gjk_distance(const convex_shape& A, const convex_shape& B, const placement& T_ab,
                                             double limit, gjk_cache& cache) noexcept {
  constexpr std::uint32_t max_iterations = 64;
  constexpr double relative_gap = 1e-14;

  const auto make = [&](std::uint32_t ia, std::uint32_t ib) {
    detail::difference_vertex v;
    v.a = A.vertex(ia);
    v.b = T_ab * B.vertex(ib);
    v.w = v.a - v.b;
    v.ia = ia;
    v.ib = ib;
    return v;
  };
  const auto furthest = [&](const vec3& d) { return make(A.support(d), B.support(T_ab.to_local(-d))); };

  detail::simplex s;
  for (std::uint32_t i = 0; i < cache.size; ++i) s.v[s.size++] = make(cache.a[i], cache.b[i]);
  const bool warm = s.size > 0;
  if (!warm) s.v[s.size++] = furthest(T_ab * B.centre - A.centre);

  // Lengths below this are rounding: the shapes touch.
  const double touching = 1e-12 * (A.radius + B.radius);
  gjk_result out;
  vec3 v(0.0);
  double previous = std::numeric_limits<double>::infinity();
  double proven = 0.0;  // no two points are closer than this
  for (;;) {
    bool inside = false;
    switch (s.size) {
      case 1:
        detail::keep_vertex(s, 0);
        break;
      case 2:
        detail::reduce_segment(s);
        break;
      case 3:
        detail::reduce_triangle(s);
        break;
      default:
        inside = detail::reduce_tetrahedron(s);
    }
    ++out.iterations;
    v = s.closest();
    const double length2 = glm::dot(v, v);
    if (inside || length2 <= touching * touching) {
      cache.size = 0;
      return out;
    }
    if (length2 >= previous || out.iterations == max_iterations) break;  // rounding ended the progress
    previous = length2;

    const detail::difference_vertex next = furthest(-v);
    const double bound = glm::dot(v, next.w);
    if (bound > 0.0 && bound * bound > limit * limit * length2) {
      out.outcome = gjk_outcome::beyond;
      break;
    }
    proven = std::max(proven, bound / std::sqrt(length2));
    if (length2 - bound <= relative_gap * length2) break;
    bool known = false;
    for (std::size_t i = 0; i < s.size; ++i) known = known || (s.v[i].ia == next.ia && s.v[i].ib == next.ib);
    if (known) break;
    s.v[s.size++] = next;
  }
  // A stale simplex can be degenerate and stop short of the closest points. Then the search starts again from nothing.
  constexpr double stopped_short = 1e-9;
  if (warm && out.outcome != gjk_outcome::beyond && std::sqrt(glm::dot(v, v)) - proven > stopped_short * proven) {
    cache.size = 0;
    const std::uint32_t spent = out.iterations;
    out = gjk_distance(A, B, T_ab, limit, cache);
    out.iterations += spent;
    return out;
  }
  cache.size = static_cast<std::uint32_t>(s.size < 4 ? s.size : 0);
  for (std::uint32_t i = 0; i < cache.size; ++i) {
    cache.a[i] = s.v[i].ia;
    cache.b[i] = s.v[i].ib;
  }
  if (out.outcome == gjk_outcome::beyond) return out;
  out.distance = std::sqrt(glm::dot(v, v));
  out.outcome = out.distance > limit ? gjk_outcome::beyond : gjk_outcome::separated;
  out.n_ab = v / -out.distance;
  for (std::size_t i = 0; i < s.size; ++i) {
    out.p_a += s.v[i].share * s.v[i].a;
    out.p_b += s.v[i].share * s.v[i].b;
  }
  return out;
}

}  // namespace asperity
