// What a contact's stiffness and the inertia against it ask of an explicit time step.
#pragma once

#include <cmath>
#include <cstddef>

#include "asperity/core/spatial.hpp"

namespace asperity::mujoco {

/// a b. @rt safe
[[nodiscard]] inline mat6 product(const mat6& a, const mat6& b) noexcept {
  mat6 out;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) {
      for (std::size_t j = 0; j < 6; ++j) out(i, j) += a(i, k) * b(k, j);
    }
  }
  return out;
}

/// An upper bound of the largest eigenvalue of a b, at most a quarter above it: the eighth root of the sum of its eigenvalues'
/// eighth powers. @pre a and b symmetric positive semidefinite, so that no eigenvalue is negative   @rt safe
[[nodiscard]] inline double largest_eigenvalue_of(const mat6& a, const mat6& b) noexcept {
  mat6 power = product(a, b);
  double size = 0.0;
  for (const double x : power.m) size = std::fmax(size, std::fabs(x));
  if (!(size > 0.0)) return 0.0;
  power = (1.0 / size) * power;
  for (int i = 0; i < 3; ++i) power = product(power, power);
  double trace = 0.0;
  for (std::size_t i = 0; i < 6; ++i) trace += power(i, i);
  return size * std::pow(std::fmax(trace, 0.0), 0.125);
}

}  // namespace asperity::mujoco
