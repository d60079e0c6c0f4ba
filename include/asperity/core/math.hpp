// Vector aliases and the few functions of rigid-body mathematics that GLM does not have.
#pragma once

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#ifdef __FAST_MATH__
#error "asperity: -ffast-math removes the NaN checks that stand between a fault and a person's hand; build without it"
#endif

namespace asperity {

using vec2 = glm::dvec2;
using vec3 = glm::dvec3;
using mat3 = glm::dmat3;
using quat = glm::dquat;

/// True where every component is an ordinary number (no NaN, no infinity).
/// @rt safe
[[nodiscard]] inline bool is_finite(const vec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Cross-product matrix: skew(a) * b == cross(a, b).
/// @rt safe
[[nodiscard]] inline mat3 skew(const vec3& a) noexcept {
  return {0.0, a.z, -a.y, -a.z, 0.0, a.x, a.y, -a.x, 0.0};  // GLM fills columns
}

/// Unit quaternion of a rotation vector (axis times angle, rad).
/// @rt safe
[[nodiscard]] inline quat exp_rotation(const vec3& phi) noexcept {
  const double angle = std::sqrt(glm::dot(phi, phi));
  // sin(x/2)/x by its series where the quotient would lose digits
  const double s = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * phi.x, s * phi.y, s * phi.z};
}

/// Rotation vector (rad, length at most pi) of a unit quaternion; inverse of exp_rotation.
/// @rt safe
[[nodiscard]] inline vec3 log_rotation(const quat& q) noexcept {
  const double sign = q.w < 0.0 ? -1.0 : 1.0;  // q and -q are the same rotation: take the short way round
  const vec3 im = sign * vec3(q.x, q.y, q.z);
  const double s = std::sqrt(glm::dot(im, im));
  const double w = sign * q.w;
  const double k = s < 1e-9 ? 2.0 / w : 2.0 * std::atan2(s, w) / s;
  return k * im;
}

/// 3x^2 - 2x^3 between 0 and 1, constant outside: continuous with its first derivative.
/// @rt safe
[[nodiscard]] inline double smoothstep(double x) noexcept {
  const double t = x < 0.0 ? 0.0 : (x > 1.0 ? 1.0 : x);
  return t * t * (3.0 - 2.0 * t);
}

/// Derivative of smoothstep.
/// @rt safe
[[nodiscard]] inline double smoothstep_slope(double x) noexcept {
  return x <= 0.0 || x >= 1.0 ? 0.0 : 6.0 * x * (1.0 - x);
}

/// A unit vector orthogonal to the unit vector n, by removing n from the axis of its smallest component.
/// @rt safe
[[nodiscard]] inline vec3 any_orthogonal(const vec3& n) noexcept {
  const vec3 a = glm::abs(n);
  const vec3 axis = a.x <= a.y && a.x <= a.z ? vec3(1, 0, 0) : (a.y <= a.z ? vec3(0, 1, 0) : vec3(0, 0, 1));
  return glm::normalize(axis - glm::dot(axis, n) * n);
}

}  // namespace asperity
