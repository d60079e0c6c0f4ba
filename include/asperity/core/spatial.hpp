// Six-dimensional motion and effort: twist, wrench, and the 6x6 matrices between them.
#pragma once

#include <array>
#include <cstddef>

#include "asperity/core/math.hpp"

namespace asperity {

/// A linear and an angular 3-vector, in this order everywhere: (translation; rotation) or (force; torque).
struct vec6 {
  vec3 linear{0.0};
  vec3 angular{0.0};

  [[nodiscard]] double operator[](std::size_t i) const noexcept {
    return i < 3 ? linear[static_cast<int>(i)] : angular[static_cast<int>(i - 3)];
  }
  [[nodiscard]] double& operator[](std::size_t i) noexcept {
    return i < 3 ? linear[static_cast<int>(i)] : angular[static_cast<int>(i - 3)];
  }
  friend vec6 operator+(const vec6& a, const vec6& b) noexcept { return {a.linear + b.linear, a.angular + b.angular}; }
  friend vec6 operator-(const vec6& a, const vec6& b) noexcept { return {a.linear - b.linear, a.angular - b.angular}; }
  friend vec6 operator*(double s, const vec6& a) noexcept { return {s * a.linear, s * a.angular}; }
  vec6& operator+=(const vec6& b) noexcept { return *this = *this + b; }
};

/// @rt safe
[[nodiscard]] inline double dot(const vec6& a, const vec6& b) noexcept {
  return glm::dot(a.linear, b.linear) + glm::dot(a.angular, b.angular);
}

/// @rt safe
[[nodiscard]] inline bool is_finite(const vec6& v) noexcept { return is_finite(v.linear) && is_finite(v.angular); }

/// Velocity of a body: linear (m/s) of a stated point and angular (rad/s), in a stated frame.
struct twist {
  vec3 linear{0.0};   ///< m/s
  vec3 angular{0.0};  ///< rad/s
};

/// Force (N) and torque (N m) about a stated point, in a stated frame.
struct wrench {
  vec3 force{0.0};   ///< N
  vec3 torque{0.0};  ///< N m

  friend wrench operator+(const wrench& a, const wrench& b) noexcept {
    return {a.force + b.force, a.torque + b.torque};
  }
  friend wrench operator-(const wrench& a, const wrench& b) noexcept {
    return {a.force - b.force, a.torque - b.torque};
  }
  friend wrench operator*(double s, const wrench& a) noexcept { return {s * a.force, s * a.torque}; }
  wrench& operator+=(const wrench& b) noexcept { return *this = *this + b; }
};

[[nodiscard]] inline vec6 to_vec6(const wrench& w) noexcept { return {w.force, w.torque}; }
[[nodiscard]] inline vec6 to_vec6(const twist& v) noexcept { return {v.linear, v.angular}; }
[[nodiscard]] inline wrench to_wrench(const vec6& v) noexcept { return {v.linear, v.angular}; }
[[nodiscard]] inline twist to_twist(const vec6& v) noexcept { return {v.linear, v.angular}; }
/// @rt safe
[[nodiscard]] inline bool is_finite(const wrench& w) noexcept { return is_finite(w.force) && is_finite(w.torque); }
/// @rt safe
[[nodiscard]] inline bool is_zero(const wrench& w) noexcept { return w.force == vec3(0.0) && w.torque == vec3(0.0); }

/// The same effort about another point: torque about `to` of a wrench whose torque is about `from` (same frame).
/// @rt safe
[[nodiscard]] inline wrench transport(const wrench& w, const vec3& from, const vec3& to) noexcept {
  return {w.force, w.torque + glm::cross(from - to, w.force)};
}

/// 6x6 matrix, row-major; rows and columns in the order of vec6.
struct mat6 {
  std::array<double, 36> m{};

  [[nodiscard]] double operator()(std::size_t row, std::size_t col) const noexcept { return m[6 * row + col]; }
  [[nodiscard]] double& operator()(std::size_t row, std::size_t col) noexcept { return m[6 * row + col]; }
  mat6& operator+=(const mat6& b) noexcept {
    for (std::size_t i = 0; i < 36; ++i) m[i] += b.m[i];
    return *this;
  }
  friend mat6 operator+(mat6 a, const mat6& b) noexcept { return a += b; }
  friend mat6 operator*(double s, mat6 a) noexcept {
    for (double& x : a.m) x *= s;
    return a;
  }
  friend mat6 operator-(mat6 a, const mat6& b) noexcept { return a += -1.0 * b; }
  friend vec6 operator*(const mat6& a, const vec6& x) noexcept {
    vec6 y;
    for (std::size_t i = 0; i < 6; ++i) {
      double s = 0.0;
      for (std::size_t j = 0; j < 6; ++j) s += a(i, j) * x[j];
      y[i] = s;
    }
    return y;
  }
};

/// @rt safe
[[nodiscard]] inline bool is_finite(const mat6& a) noexcept {
  for (const double x : a.m) {
    if (!std::isfinite(x)) return false;
  }
  return true;
}

/// Adds s * a * a^T; a symmetric matrix stays symmetric to the bit.
/// @rt safe
inline void add_outer(mat6& to, double s, const vec6& a) noexcept {
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) to(i, j) += s * (a[i] * a[j]);
  }
}

/// Sets the 3x3 block whose upper left corner is (row, col).
/// @rt safe
inline void set_block(mat6& to, std::size_t row, std::size_t col, const mat3& b) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) to(row + i, col + j) = b[static_cast<int>(j)][static_cast<int>(i)];
  }
}

/// x with A x = b by Gaussian elimination with partial pivoting; false (x untouched) where A is singular or not finite.
/// @rt safe: fixed cost
[[nodiscard]] inline bool solve(mat6 a, vec6 b, vec6& x) noexcept {
  for (std::size_t k = 0; k < 6; ++k) {
    std::size_t p = k;
    for (std::size_t i = k + 1; i < 6; ++i) {
      if (std::fabs(a(i, k)) > std::fabs(a(p, k))) p = i;
    }
    if (!(std::fabs(a(p, k)) > 0.0)) return false;  // zero or NaN
    if (p != k) {
      for (std::size_t j = 0; j < 6; ++j) {
        const double t = a(k, j);
        a(k, j) = a(p, j);
        a(p, j) = t;
      }
      const double t = b[k];
      b[k] = b[p];
      b[p] = t;
    }
    for (std::size_t i = k + 1; i < 6; ++i) {
      const double f = a(i, k) / a(k, k);
      for (std::size_t j = k; j < 6; ++j) a(i, j) -= f * a(k, j);
      b[i] -= f * b[k];
    }
  }
  vec6 y;
  for (std::size_t k = 6; k-- > 0;) {
    double s = b[k];
    for (std::size_t j = k + 1; j < 6; ++j) s -= a(k, j) * y[j];
    y[k] = s / a(k, k);
  }
  if (!is_finite(y)) return false;
  x = y;
  return true;
}

}  // namespace asperity
