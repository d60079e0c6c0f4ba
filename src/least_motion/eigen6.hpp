// The negative part of a symmetric 6 x 6 matrix.
#pragma once

#include <cmath>
#include <cstddef>

#include "asperity/core/spatial.hpp"

namespace asperity::exits {

/// The symmetric matrix without its positive eigenvalues, where lengths and angles compare as length_m to 1 rad: the
/// nearest negative semidefinite one. By Jacobi rotations.
/// @param a symmetric, finite   @rt safe: at most 12 sweeps
[[nodiscard]] inline mat6 negative_part(const mat6& a, double length_m) noexcept {
  const auto scale = [length_m](std::size_t i) { return i < 3 ? 1.0 : 1.0 / length_m; };
  mat6 d, v;
  double size = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    v(i, i) = 1.0;
    for (std::size_t j = 0; j < 6; ++j) {
      d(i, j) = scale(i) * scale(j) * a(i, j);
      size += d(i, j) * d(i, j);
    }
  }
  for (int sweep = 0; sweep < 12; ++sweep) {
    double off = 0.0;
    for (std::size_t p = 0; p < 6; ++p) {
      for (std::size_t q = p + 1; q < 6; ++q) {
        off += d(p, q) * d(p, q);
        if (!(std::fabs(d(p, q)) > 0.0)) continue;
        const double theta = 0.5 * (d(q, q) - d(p, p)) / d(p, q);
        const double t = (theta < 0.0 ? -1.0 : 1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        for (std::size_t k = 0; k < 6; ++k) {
          const double kp = d(k, p), kq = d(k, q);
          d(k, p) = c * kp - s * kq;
          d(k, q) = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 6; ++k) {
          const double pk = d(p, k), qk = d(q, k), vp = v(k, p), vq = v(k, q);
          d(p, k) = c * pk - s * qk;
          d(q, k) = s * pk + c * qk;
          v(k, p) = c * vp - s * vq;
          v(k, q) = s * vp + c * vq;
        }
      }
    }
    if (off <= 1e-24 * size) break;
  }
  mat6 out;
  for (std::size_t k = 0; k < 6; ++k) {
    if (!(d(k, k) < 0.0)) continue;
    vec6 u;
    for (std::size_t i = 0; i < 6; ++i) u[i] = v(i, k) / scale(i);
    add_outer(out, d(k, k), u);
  }
  return out;
}

}  // namespace asperity::exits
