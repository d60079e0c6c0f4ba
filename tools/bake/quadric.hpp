// Sum of squared distances to planes: what an edge collapse costs.
#pragma once

#include <algorithm>
#include <array>

#include "asperity/core/math.hpp"

namespace asperity::bake {

/// x A x - 2 b x + c for points x, each plane weighted with an area. A is symmetric: six of its numbers are kept.
/// @source M. Garland and P. Heckbert, Surface simplification using quadric error metrics, 1997
struct quadric {
  std::array<double, 6> a{};  ///< xx, xy, xz, yy, yz, zz
  vec3 b{0.0};
  double c = 0.0;
  double weight = 0.0;  ///< sum of the areas, m^2

  /// The squared distance to the plane through `point`, times `area`. @pre |normal| = 1
  [[nodiscard]] static quadric of_plane(const vec3& normal, const vec3& point, double area) noexcept {
    const vec3& n = normal;
    const double d = glm::dot(n, point);
    return {{area * (n.x * n.x), area * (n.x * n.y), area * (n.x * n.z), area * (n.y * n.y), area * (n.y * n.z),
             area * (n.z * n.z)},
            area * d * n,
            area * d * d,
            area};
  }

  quadric& operator+=(const quadric& o) noexcept {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += o.a[i];
    b += o.b;
    c += o.c;
    weight += o.weight;
    return *this;
  }

  [[nodiscard]] mat3 matrix() const noexcept { return {a[0], a[1], a[2], a[1], a[3], a[4], a[2], a[4], a[5]}; }

  [[nodiscard]] double at(const vec3& x) const noexcept {
    return std::max(0.0, glm::dot(x, matrix() * x) - 2.0 * glm::dot(b, x) + c);
  }
};

}  // namespace asperity::bake
