// Small motions of the probe, and derivatives by them.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity::test_support {

/// The probe moved by q = (translation of c_w; rotation about it), world axes.
[[nodiscard]] inline pose displaced(const pose& T_wa, const vec3& c_w, const vec6& q) {
  const quat turn = exp_rotation(q.angular);
  return {glm::normalize(turn * T_wa.rotation), c_w + q.linear + turn * (T_wa.position - c_w)};
}

/// Derivative of f(q) at q = 0 by central differences: translations by step, rotations by step / lever.
template <class F>
[[nodiscard]] vec6 derivative(F&& f, double step_m, double lever_m) {
  vec6 out;
  for (std::size_t i = 0; i < 6; ++i) {
    vec6 q;
    q[i] = i < 3 ? step_m : step_m / lever_m;
    out[i] = (f(q) - f(-1.0 * q)) / (2.0 * q[i]);
  }
  return out;
}

/// Largest component of a slope, angular ones per lever.
[[nodiscard]] inline double largest(const vec6& g, double lever_m) {
  double out = 0.0;
  for (std::size_t i = 0; i < 6; ++i) out = std::max(out, std::fabs(g[i]) / (i < 3 ? 1.0 : lever_m));
  return out;
}

}  // namespace asperity::test_support
