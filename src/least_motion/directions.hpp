// Directions spread evenly over the sphere.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "asperity/core/math.hpp"

namespace asperity::exits {

/// Unit vectors to the corners of an icosahedron whose edges are cut into `parts`: 10 parts^2 + 2 of them, no two
/// neighbours further apart than about 1.1 / parts rad. Allocates.
[[nodiscard]] inline std::vector<vec3> even_directions(int parts) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::array<vec3, 12> corner;
  std::size_t n = 0;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      corner[n++] = {0.0, a, b};
      corner[n++] = {a, b, 0.0};
      corner[n++] = {b, 0.0, a};
    }
  }
  std::vector<vec3> out;
  const auto add = [&](const vec3& d) {
    const vec3 u = glm::normalize(d);
    for (const vec3& v : out) {
      if (glm::length(u - v) < 1e-6) return;
    }
    out.push_back(u);
  };
  const auto neighbours = [](const vec3& a, const vec3& b) { return std::fabs(glm::length(a - b) - 2.0) < 1e-6; };
  for (std::size_t a = 0; a < 12; ++a) {
    for (std::size_t b = a + 1; b < 12; ++b) {
      for (std::size_t c = b + 1; c < 12; ++c) {
        const bool face =
            neighbours(corner[a], corner[b]) && neighbours(corner[b], corner[c]) && neighbours(corner[a], corner[c]);
        if (!face) continue;
        for (int i = 0; i <= parts; ++i) {
          for (int j = 0; i + j <= parts; ++j) {
            add(static_cast<double>(i) * corner[a] + static_cast<double>(j) * corner[b] +
                static_cast<double>(parts - i - j) * corner[c]);
          }
        }
      }
    }
  }
  return out;
}

}  // namespace asperity::exits
