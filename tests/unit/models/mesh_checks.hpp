// What a test needs to know about a triangle mesh: topology, volume, distances, self-intersections.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::test {

inline std::array<vec3, 3> corners(const triangle_mesh& mesh, std::size_t t) {
  const auto& v = mesh.triangles[t];
  return {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
}

struct topology {
  bool closed_manifold = false;  ///< every directed edge once, with its opposite; the triangles of each vertex one fan
  std::size_t components = 0;
  std::ptrdiff_t euler = 0;
};

/// @pre every index is inside positions
inline topology topology_of(const triangle_mesh& mesh) {
  struct corner {
    std::uint32_t v, next, last;
  };
  std::vector<corner> list;
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      list.push_back({t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
      parent[root(t[i])] = root(t[(i + 1) % 3]);
    }
  std::sort(list.begin(), list.end(), [](const corner& a, const corner& b) {
    return a.v != b.v ? a.v < b.v : (a.next != b.next ? a.next < b.next : a.last < b.last);
  });

  topology out;
  out.closed_manifold = true;
  std::size_t vertices = 0;
  for (std::size_t begin = 0; begin < list.size();) {
    std::size_t end = begin;
    while (end < list.size() && list[end].v == list[begin].v) ++end;
    ++vertices;
    // From the first triangle across its last edge to the next, until the walk is back: it must see each one once.
    std::uint32_t at = list[begin].next;
    std::size_t steps = 0;
    do {
      const auto first = list.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last = list.begin() + static_cast<std::ptrdiff_t>(end);
      const auto here = std::lower_bound(first, last, at, [](const corner& c, std::uint32_t w) { return c.next < w; });
      if (here == last || here->next != at) break;
      at = here->last;
      ++steps;
    } while (at != list[begin].next && steps <= end - begin);
    if (at != list[begin].next || steps != end - begin) out.closed_manifold = false;
    begin = end;
  }
  if (vertices != mesh.positions.size()) out.closed_manifold = false;  // a vertex without a triangle
  for (std::uint32_t v = 0; v < parent.size(); ++v)
    if (root(v) == v) ++out.components;
  out.euler = static_cast<std::ptrdiff_t>(vertices) - static_cast<std::ptrdiff_t>(mesh.triangles.size() / 2);
  return out;
}

inline double volume_of(const triangle_mesh& mesh) {
  double six = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    six += glm::dot(c[0], glm::cross(c[1], c[2]));
  }
  return six / 6.0;
}

inline double smallest_area(const triangle_mesh& mesh) {
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    out = std::min(out, 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0])));
  }
  return out;
}

/// FNV-1a over all bits of positions and indices.
inline std::uint64_t digest_of(const triangle_mesh& mesh) {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto add = [&hash](std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((word >> (8 * byte)) & 0xffU)) * 1099511628211ULL;
  };
  for (const vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) {
      std::uint64_t bits = 0;
      const double x = p[axis];
      std::memcpy(&bits, &x, sizeof bits);
      add(bits);
    }
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) add(v);
  return hash;
}

/// Distance of p to the triangle c.
inline double distance_to(const vec3& p, const std::array<vec3, 3>& c) {
  const vec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const vec3 e = c[(i + 1) % 3] - c[i];
    if (glm::dot(glm::cross(e, p - c[i]), n) < 0.0) inside = false;
    const double s = std::clamp(glm::dot(p - c[i], e) / glm::dot(e, e), 0.0, 1.0);
    nearest = std::min(nearest, glm::length(p - c[i] - s * e));
  }
  return inside ? std::abs(glm::dot(p - c[0], n)) / glm::length(n) : nearest;
}

/// Largest distance of a vertex of `from` to the surface of `to`.
inline double largest_distance(const triangle_mesh& from, const triangle_mesh& to) {
  struct ball {
    vec3 centre;
    double radius;
  };
  std::vector<ball> balls;
  for (std::size_t t = 0; t < to.triangles.size(); ++t) {
    const auto c = corners(to, t);
    const vec3 centre = (c[0] + c[1] + c[2]) / 3.0;
    balls.push_back({centre, std::max(glm::length(c[0] - centre),
                                      std::max(glm::length(c[1] - centre), glm::length(c[2] - centre)))});
  }
  double out = 0.0;
  for (const vec3& p : from.positions) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < to.triangles.size(); ++t) {
      const vec3 d = p - balls[t].centre;
      const double reach = nearest + balls[t].radius;
      if (glm::dot(d, d) < reach * reach) nearest = std::min(nearest, distance_to(p, corners(to, t)));
    }
    out = std::max(out, nearest);
  }
  return out;
}

/// True where the segment pq passes through the triangle c.
inline bool crosses(const vec3& p, const vec3& q, const std::array<vec3, 3>& c) {
  const vec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
  const double hp = glm::dot(p - c[0], n);
  const double hq = glm::dot(q - c[0], n);
  if ((hp > 0.0) == (hq > 0.0)) return false;
  const vec3 x = p + hp / (hp - hq) * (q - p);
  for (std::size_t i = 0; i < 3; ++i)
    if (glm::dot(glm::cross(c[(i + 1) % 3] - c[i], x - c[i]), n) < 0.0) return false;
  return true;
}

/// Pairs of triangles without a common vertex that cut each other. A grid finds the candidates.
inline std::size_t self_intersections(const triangle_mesh& mesh) {
  struct entry {
    std::uint64_t cell;
    std::uint32_t triangle;
  };
  double length = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    length += glm::length(c[1] - c[0]) / static_cast<double>(mesh.triangles.size());
  }
  const double cell = 2.0 * length;
  std::vector<std::array<vec3, 2>> boxes;
  std::vector<entry> entries;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    boxes.push_back({glm::min(c[0], glm::min(c[1], c[2])), glm::max(c[0], glm::max(c[1], c[2]))});
    const auto index = [cell](double x) { return static_cast<std::uint64_t>(std::floor(x / cell) + 1048576.0); };
    for (std::uint64_t i = index(boxes[t][0].x); i <= index(boxes[t][1].x); ++i)
      for (std::uint64_t j = index(boxes[t][0].y); j <= index(boxes[t][1].y); ++j)
        for (std::uint64_t k = index(boxes[t][0].z); k <= index(boxes[t][1].z); ++k)
          entries.push_back({(i << 42) | (j << 21) | k, t});
  }
  std::sort(entries.begin(), entries.end(), [](const entry& a, const entry& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.triangle < b.triangle;
  });
  std::size_t found = 0;
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].cell == entries[begin].cell) ++end;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = i + 1; j < end; ++j) {
        const std::uint32_t s = entries[i].triangle;
        const std::uint32_t t = entries[j].triangle;
        const auto& a = boxes[s];
        const auto& b = boxes[t];
        if (a[0].x > b[1].x || b[0].x > a[1].x || a[0].y > b[1].y || b[0].y > a[1].y || a[0].z > b[1].z ||
            b[0].z > a[1].z)
          continue;
        bool share = false;
        for (const std::uint32_t v : mesh.triangles[s])
          for (const std::uint32_t w : mesh.triangles[t]) share = share || v == w;
        if (share) continue;
        const auto p = corners(mesh, s);
        const auto q = corners(mesh, t);
        for (std::size_t e = 0; e < 3; ++e)
          if (crosses(p[e], p[(e + 1) % 3], q) || crosses(q[e], q[(e + 1) % 3], p)) {
            ++found;
            break;
          }
      }
  }
  return found;
}

}  // namespace asperity::test
