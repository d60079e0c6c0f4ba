// Convex polyhedra from seeded random points, and slow, independent answers about their distance and overlap.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "asperity/model/coarse_mesh.hpp"

namespace asperity::test {

/// Uniform doubles that are the same with every standard library.
class uniform_source {
 public:
  explicit uniform_source(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1.0p-53;
  }
  vec3 in_box(double half) { return {(*this)(-half, half), (*this)(-half, half), (*this)(-half, half)}; }
  vec3 direction() {
    for (;;) {
      const vec3 v = in_box(1.0);
      const double l = glm::dot(v, v);
      if (l > 0.01 && l < 1.0) return v / std::sqrt(l);
    }
  }

 private:
  std::mt19937_64 engine_;
};

/// Hull of points in general position, by trying every triple. Cost is the fourth power of their number.
inline coarse_mesh brute_hull(const std::vector<vec3>& points) {
  coarse_mesh mesh;
  std::vector<int> used(points.size(), -1);
  const auto use = [&](std::size_t i) {
    if (used[i] < 0) {
      used[i] = static_cast<int>(mesh.positions.size());
      mesh.positions.push_back(points[i]);
    }
    return static_cast<std::uint32_t>(used[i]);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const vec3 n = glm::cross(points[j] - points[i], points[k] - points[i]);
        bool above = false, below = false;
        for (std::size_t m = 0; m < points.size(); ++m) {
          if (m == i || m == j || m == k) continue;
          (glm::dot(n, points[m] - points[i]) > 0.0 ? above : below) = true;
        }
        if (above && below) continue;
        coarse_triangle t;
        t.vertex = above ? std::array{use(i), use(k), use(j)} : std::array{use(i), use(j), use(k)};
        mesh.triangles.push_back(t);
      }
    }
  }
  return mesh;
}

/// One triangle: the flattest piece there is. An open mesh.
inline coarse_mesh triangle_mesh_of(const std::array<vec3, 3>& c) {
  coarse_mesh mesh;
  mesh.positions = {c[0], c[1], c[2]};
  coarse_triangle t;
  t.vertex = {0, 1, 2};
  mesh.triangles.push_back(t);
  return mesh;
}

namespace detail {

inline double point_triangle(const vec3& p, const std::array<vec3, 3>& t) {
  const vec3 n = glm::normalize(area_normal(t));
  const vec3 foot = p - glm::dot(n, p - t[0]) * n;
  bool inside = true;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const vec3 a = t[i], e = t[(i + 1) % 3] - t[i];
    inside = inside && glm::dot(glm::cross(e, foot - a), n) >= 0.0;
    best = std::min(best, glm::distance(p, a + std::clamp(glm::dot(p - a, e) / glm::dot(e, e), 0.0, 1.0) * e));
  }
  return inside ? std::fabs(glm::dot(n, p - t[0])) : best;
}

/// Interior of both segments only: ends are covered by point_triangle.
inline double edge_edge(const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
  const vec3 u = b - a, v = d - c, w = c - a;
  const vec3 n = glm::cross(u, v);
  const double n2 = glm::dot(n, n);
  if (n2 < 1e-20) return std::numeric_limits<double>::infinity();
  const double s = glm::dot(glm::cross(w, v), n) / n2;
  const double t = glm::dot(glm::cross(w, u), n) / n2;
  if (s < 0.0 || s > 1.0 || t < 0.0 || t > 1.0) return std::numeric_limits<double>::infinity();
  return std::fabs(glm::dot(w, n)) / std::sqrt(n2);
}

}  // namespace detail

/// Distance between the surfaces of two meshes that do not cross, over all vertex-face and edge-edge pairs.
inline double brute_distance(const coarse_mesh& a, const coarse_mesh& b) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    const auto p = corners(a, i);
    for (std::size_t j = 0; j < b.triangles.size(); ++j) {
      const auto q = corners(b, j);
      for (std::size_t k = 0; k < 3; ++k) {
        best = std::min({best, detail::point_triangle(p[k], q), detail::point_triangle(q[k], p)});
        for (std::size_t m = 0; m < 3; ++m) {
          best = std::min(best, detail::edge_edge(p[k], p[(k + 1) % 3], q[m], q[(m + 1) % 3]));
        }
      }
    }
  }
  return best;
}

/// Largest separation of two convex meshes over every face normal and every pair of edges, both signs. Positive where
/// they are apart; minus the penetration depth where they overlap.
inline double brute_separation(const coarse_mesh& a, const coarse_mesh& b) {
  const auto along = [&](const vec3& n) {
    double low_b = std::numeric_limits<double>::infinity(), high_a = -low_b;
    for (const vec3& p : a.positions) high_a = std::max(high_a, glm::dot(n, p));
    for (const vec3& p : b.positions) low_b = std::min(low_b, glm::dot(n, p));
    return low_b - high_a;
  };
  double best = -std::numeric_limits<double>::infinity();
  const auto try_both = [&](const vec3& d) {
    const double length = std::sqrt(glm::dot(d, d));
    if (length < 1e-9) return;
    best = std::max({best, along(d / length), along(-d / length)});
  };
  for (std::size_t i = 0; i < a.triangles.size(); ++i) try_both(area_normal(corners(a, i)));
  for (std::size_t j = 0; j < b.triangles.size(); ++j) try_both(area_normal(corners(b, j)));
  const auto edges = [](const coarse_mesh& m) {
    std::vector<vec3> out;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const auto& v = m.triangles[t].vertex;
      for (std::size_t k = 0; k < 3; ++k) {
        if (v[k] < v[(k + 1) % 3] || m.triangles.size() == 1) {
          out.push_back(glm::normalize(m.positions[v[(k + 1) % 3]] - m.positions[v[k]]));
        }
      }
    }
    return out;
  };
  const auto ea = edges(a), eb = edges(b);
  for (const vec3& u : ea) {
    for (const vec3& v : eb) try_both(glm::cross(u, v));
  }
  return best;
}

}  // namespace asperity::test
