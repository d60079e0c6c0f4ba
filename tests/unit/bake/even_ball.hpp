// A ball of triangles of nearly one size, and what may be wrong with a mesh of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "shapes.hpp"

namespace asperity::bake::shapes {

// An octahedron cut `times` times, its vertices on a sphere about `at`.
inline triangle_mesh ball(double radius_m, int times, const vec3& at = vec3(0.0)) {
  triangle_mesh m{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                  {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
                  {}};
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(m.positions.size()));
      if (added) m.positions.push_back(glm::normalize(m.positions[a] + m.positions[b]));
      return found->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : m.triangles) {
      const std::uint32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    m.triangles = std::move(finer);
  }
  for (vec3& p : m.positions) p = at + radius_m * p;
  return m;
}

inline triangle_mesh turned_at_random(triangle_mesh m, dice& draw, double share) {
  for (auto& t : m.triangles)
    if (draw() < share) std::swap(t[1], t[2]);
  return m;
}

inline triangle_mesh without_some(triangle_mesh m, dice& draw, double share) {
  std::erase_if(m.triangles, [&](const auto&) { return draw() < share; });
  return m;
}

}  // namespace asperity::bake::shapes
