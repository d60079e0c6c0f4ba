// Clean meshes with a known amount of dirt on them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "shapes.hpp"

namespace asperity::bake::dirt {

inline triangle_mesh ball(std::uint32_t rings, std::uint32_t around, double radius_m = 0.05) {
  triangle_mesh out;
  out.positions.emplace_back(0.0, 0.0, radius_m);
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2.0 * std::numbers::pi * j / around;
      out.positions.push_back(radius_m * vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
    }
  out.positions.emplace_back(0.0, 0.0, -radius_m);
  const auto last = static_cast<std::uint32_t>(out.positions.size() - 1);
  const auto ring = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    out.triangles.push_back({0, ring(1, j), ring(1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      out.triangles.push_back({ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)});
      out.triangles.push_back({ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)});
    }
    out.triangles.push_back({last, ring(rings - 1, j + 1), ring(rings - 1, j)});
  }
  return out;
}

inline double area(const triangle_mesh& m) {
  double sum = 0.0;
  for (const auto& t : m.triangles)
    sum += 0.5 * glm::length(glm::cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]));
  return sum;
}
inline double volume(const triangle_mesh& m) {
  double six = 0.0;
  for (const auto& t : m.triangles)
    six += glm::dot(m.positions[t[0]], glm::cross(m.positions[t[1]], m.positions[t[2]]));
  return six / 6.0;
}

enum class kind {
  unwelded,
  cracks,
  degenerate_split,
  same_twice,
  both_sides,
  fin,
  hole,
  inner_ball,
  inner_wall,
  shard,
  turned
};
inline constexpr int kinds = 11;
inline const char* name(kind k) {
  constexpr const char* names[] = {"unwelded", "cracks",     "cap",        "same twice", "both sides", "fin",
                                   "hole",     "inner ball", "inner wall", "shard",      "turned"};
  return names[static_cast<int>(k)];
}

/// Puts one defect of a kind on a mesh.
inline void plant(triangle_mesh& m, kind k, shapes::dice& dice) {
  const auto any = [&] { return dice.below(m.triangles.size()); };
  const auto fresh = [&](const vec3& p) {
    m.positions.push_back(p);
    return static_cast<std::uint32_t>(m.positions.size() - 1);
  };
  switch (k) {
    case kind::unwelded: {  // every triangle with vertices of its own
      triangle_mesh out;
      for (const auto& t : m.triangles) {
        const auto n = static_cast<std::uint32_t>(out.positions.size());
        for (const auto v : t) out.positions.push_back(m.positions[v]);
        out.triangles.push_back({n, n + 1, n + 2});
      }
      m = out;
      break;
    }
    case kind::cracks: {  // a triangle torn loose, its corners a little off
      auto& t = m.triangles[any()];
      for (auto& v : t) v = fresh(vec3(m.positions[v]) + 2e-8 * vec3(dice(-1, 1), dice(-1, 1), dice(-1, 1)));
      break;
    }
    case kind::degenerate_split: {  // a corner on an edge of one triangle, and a triangle without area between
      const std::size_t at = any();
      const auto t = m.triangles[at];
      const double s = dice(0.2, 0.8);
      const std::uint32_t v = fresh((1.0 - s) * m.positions[t[0]] + s * m.positions[t[1]]);
      m.triangles[at] = {t[0], v, t[2]};
      m.triangles.push_back({v, t[1], t[2]});
      m.triangles.push_back({t[0], t[1], v});
      break;
    }
    case kind::same_twice:
      m.triangles.push_back(std::array(m.triangles[any()]));
      break;
    case kind::both_sides: {
      const auto t = m.triangles[any()];
      m.triangles.push_back({t[0], t[2], t[1]});
      break;
    }
    case kind::fin: {
      const auto t = m.triangles[any()];
      const vec3 mid = 0.5 * (m.positions[t[0]] + m.positions[t[1]]);
      const std::uint32_t v = fresh(mid * 1.2);
      m.triangles.push_back({t[0], t[1], v});
      break;
    }
    case kind::hole: {
      m.triangles.erase(m.triangles.begin() + static_cast<std::ptrdiff_t>(any()));
      break;
    }
    case kind::inner_ball:  // in the middle of a ball or a box; the others have none
      m = shapes::both(m, ball(4, 6, 0.002));
      break;
    case kind::inner_wall: {  // a closed ring of three edges, walled within
      const auto t = m.triangles[any()];
      const vec3 middle = (m.positions[t[0]] + m.positions[t[1]] + m.positions[t[2]]) / 3.0;
      // Meshes lie about the origin, and the second ball of a pair about this: towards the origin its wall went through it.
      const vec3 inside = middle.x > 0.12 ? vec3(0.2, 0.0, 0.0) : vec3(0.0);
      const std::uint32_t v = fresh(middle + 0.1 * (inside - middle));
      m.triangles.push_back({t[0], t[1], v});
      m.triangles.push_back({t[1], t[2], v});
      m.triangles.push_back({t[2], t[0], v});
      break;
    }
    case kind::shard: {
      const vec3 p(0.1, 0.02 * dice(), 0.0);
      const std::uint32_t a = fresh(p), b = fresh(p + vec3(0.002, 0, 0)), c = fresh(p + vec3(0, 0.002, 0));
      m.triangles.push_back({a, b, c});
      break;
    }
    case kind::turned: {
      auto& t = m.triangles[any()];
      std::swap(t[1], t[2]);
      break;
    }
  }
}

}  // namespace asperity::bake::dirt
