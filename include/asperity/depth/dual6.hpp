// Numbers that know how they change with a motion of the probe.
#pragma once

#include <cmath>

#include "asperity/core/spatial.hpp"

namespace asperity::detail {

/// A value and its derivative by (translation; rotation) of the probe: forward differentiation.
struct dual6 {
  double value = 0.0;
  vec6 slope{};

  dual6() = default;
  explicit dual6(double v) noexcept : value(v) {}
  dual6(double v, const vec6& d) noexcept : value(v), slope(d) {}

  friend dual6 operator+(const dual6& a, const dual6& b) noexcept { return {a.value + b.value, a.slope + b.slope}; }
  friend dual6 operator-(const dual6& a, const dual6& b) noexcept { return {a.value - b.value, a.slope - b.slope}; }
  friend dual6 operator*(const dual6& a, const dual6& b) noexcept {
    return {a.value * b.value, b.value * a.slope + a.value * b.slope};
  }
  friend dual6 operator/(const dual6& a, const dual6& b) noexcept {
    const double q = a.value / b.value;
    return {q, (1.0 / b.value) * (a.slope - q * b.slope)};
  }
};

/// @pre a.value > 0
[[nodiscard]] inline dual6 square_root(const dual6& a) noexcept {
  const double r = std::sqrt(a.value);
  return {r, (0.5 / r) * a.slope};
}

[[nodiscard]] inline dual6 smooth_step(const dual6& x) noexcept {
  return {smoothstep(x.value), smoothstep_slope(x.value) * x.slope};
}

/// Three of them: a point or a direction in the world.
struct dual3 {
  dual6 x, y, z;

  dual3(const dual6& a, const dual6& b, const dual6& c) noexcept : x(a), y(b), z(c) {}
  explicit dual3(const vec3& fixed) noexcept : x(fixed.x), y(fixed.y), z(fixed.z) {}

  friend dual3 operator-(const dual3& a, const dual3& b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend dual3 operator*(const dual6& s, const dual3& a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
};

[[nodiscard]] inline dual6 dot(const dual3& a, const dual3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

[[nodiscard]] inline dual3 cross_product(const dual3& a, const dual3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A direction that turns with the probe: d = theta x direction.
[[nodiscard]] inline dual3 turning(const vec3& direction_w) noexcept {
  const vec3& v = direction_w;
  return {{v.x, {vec3(0.0), vec3(0.0, v.z, -v.y)}},
          {v.y, {vec3(0.0), vec3(-v.z, 0.0, v.x)}},
          {v.z, {vec3(0.0), vec3(v.y, -v.x, 0.0)}}};
}

/// A point of the probe: it also moves along.
[[nodiscard]] inline dual3 moving(const vec3& point_w, const vec3& c_w) noexcept {
  dual3 p = turning(point_w - c_w);
  p.x.value = point_w.x;
  p.y.value = point_w.y;
  p.z.value = point_w.z;
  p.x.slope.linear.x = p.y.slope.linear.y = p.z.slope.linear.z = 1.0;
  return p;
}

}  // namespace asperity::detail
