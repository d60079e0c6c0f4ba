// A coarse triangle in the image of its haptic texture.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "asperity/core/math.hpp"

namespace asperity::bake {

/// Its corners in texels, texel (i, j) from (i, j) to (i + 1, j + 1); turned either way.
struct image_triangle {
  std::array<vec2, 3> c;
  double twice_area;  ///< signed: negative in a mirrored chart

  image_triangle(const std::array<vec2, 3>& uv, double side) : c{side * uv[0], side * uv[1], side * uv[2]} {
    twice_area = cross(c[1] - c[0], c[2] - c[0]);
  }

  static double cross(const vec2& a, const vec2& b) noexcept { return a.x * b.y - a.y * b.x; }

  /// Barycentric coordinates. @pre it has area
  [[nodiscard]] std::array<double, 3> coordinates(const vec2& p) const noexcept {
    const double b1 = cross(p - c[0], c[2] - c[0]) / twice_area;
    const double b2 = cross(c[1] - c[0], p - c[0]) / twice_area;
    return {1.0 - b1 - b2, b1, b2};
  }

  /// Point of the triangle nearest to p: p itself where it is inside.
  [[nodiscard]] vec2 clamp(const vec2& p) const noexcept {
    const std::array<double, 3> b = coordinates(p);
    if (b[0] >= 0.0 && b[1] >= 0.0 && b[2] >= 0.0) return p;
    vec2 best = c[0];
    double best2 = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const vec2 d = c[(k + 1) % 3] - c[k];
      const double s = std::clamp(glm::dot(p - c[k], d) / glm::dot(d, d), 0.0, 1.0);
      const vec2 q = c[k] + s * d;
      const double q2 = glm::dot(p - q, p - q);
      if (q2 < best2) {
        best2 = q2;
        best = q;
      }
    }
    return best;
  }

  [[nodiscard]] vec2 low() const noexcept { return glm::min(glm::min(c[0], c[1]), c[2]); }
  [[nodiscard]] vec2 high() const noexcept { return glm::max(glm::max(c[0], c[1]), c[2]); }
};

}  // namespace asperity::bake
