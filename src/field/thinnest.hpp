// Across which plane points spread least.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <span>

#include "asperity/core/math.hpp"

namespace asperity::detail {

/// The direction along which points spread least, by the power method on the trace of their covariance less the
/// covariance. A direction that is not quite the best makes bounds a little wider, not wrong.
[[nodiscard]] inline vec3 thinnest(std::span<const glm::vec3> points, const vec3& middle_b) noexcept {
  vec3 sum(0.0), squares(0.0), mixed(0.0);  // xx, yy, zz; xy, xz, yz
  double trace = 1e-30;
  for (const glm::vec3& p : points) {
    const vec3 d = vec3(p) - middle_b, square = d * d;
    sum += d;
    squares += square;
    mixed += vec3(d.x * d.y, d.x * d.z, d.y * d.z);
    trace += square.x + square.y + square.z;
  }
  mat3 rest(-squares.x, -mixed.x, -mixed.y, -mixed.x, -squares.y, -mixed.z, -mixed.y, -mixed.z, -squares.z);
  const double per_sample = 1.0 / static_cast<double>(points.size());
  rest += per_sample * glm::outerProduct(sum, sum);
  trace -= per_sample * glm::dot(sum, sum);
  for (int k = 0; k < 3; ++k) rest[k][k] += trace;
  constexpr int steps = 20;
  vec3 axis(0.48, 0.6, 0.64);
  for (int i = 0; i < steps; ++i) {
    const vec3 next = rest * axis;
    const double squared = glm::dot(next, next);
    if (!(squared > 0.0)) break;
    axis = next / std::sqrt(squared);
  }
  return axis;
}

}  // namespace asperity::detail
