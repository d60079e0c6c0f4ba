// The smooth part of a body's depth field: a dense grid that a cubic B-spline reads.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/bspline.hpp"

namespace asperity {

/// Smooth signed distance at a point, with its first and second derivatives. Body frame, positive inside.
struct coarse_reading {
  double value_m = 0.0;
  vec3 slope{0.0};          ///< by the point's position
  mat3 hessian_per_m{0.0};  ///< symmetric
};

namespace detail {

/// Signed distances at nodes, read as coefficients of a cubic B-spline: continuous with two derivatives. A B-spline's
/// coefficients are the values of a function that it smooths over a pitch; for the smooth part that is wanted.
struct coarse_grid {
  vec3 low{0.0};  ///< the first node, body frame
  double pitch_m = 1.0;
  std::array<std::size_t, 3> nodes{};  ///< along x, y, z; at least 4 each
  std::vector<float> value;            ///< metres, x fastest

  [[nodiscard]] std::size_t at(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return (k * nodes[1] + j) * nodes[0] + i;
  }

  /// Nearest point of the region in which the spline has all of its nodes.
  [[nodiscard]] vec3 clamped(const vec3& p_b) const noexcept {
    vec3 out;
    for (int k = 0; k < 3; ++k) {
      const double last = static_cast<double>(nodes[static_cast<std::size_t>(k)]) - 2.0;
      // std::max first, so that a NaN becomes a number: an index is made of it.
      out[k] = std::min(std::max(low[k] + pitch_m, p_b[k]), low[k] + last * pitch_m);
    }
    return out;
  }

  /// Value of the node next to a point, plus how far off it is: nowhere less than a distance at the point. @rt safe
  [[nodiscard]] double most_beside(const vec3& p_b) const noexcept {
    std::array<std::size_t, 3> n{};
    vec3 off(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (p_b[axis] - low[axis]) / pitch_m;
      n[k] = static_cast<std::size_t>(std::min(std::max(0.0, g + 0.5), static_cast<double>(nodes[k]) - 1.0));
      off[axis] = g - static_cast<double>(n[k]);
    }
    return static_cast<double>(value[at(n[0], n[1], n[2])]) + pitch_m * std::sqrt(glm::dot(off, off));
  }

  /// The spline. Beyond the grid: its value at the border less the distance from there, continuous and falling.
  /// @rt safe: 64 nodes
  [[nodiscard]] coarse_reading read(const vec3& p_b) const noexcept {
    const vec3 c_b = clamped(p_b);
    std::array<std::size_t, 3> first{};
    double f[3];
    const double per_pitch = 1.0 / pitch_m;
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (c_b[axis] - low[axis]) * per_pitch;
      first[k] = static_cast<std::size_t>(std::min(std::max(1.0, g), static_cast<double>(nodes[k]) - 3.0));
      f[k] = g - static_cast<double>(first[k]);
      --first[k];
    }
    const cubic_weights wx(f[0]), wy(f[1]), wz(f[2]);
    double v = 0.0, vx = 0.0, vy = 0.0, vz = 0.0, vxx = 0.0, vxy = 0.0, vyy = 0.0, vxz = 0.0, vyz = 0.0, vzz = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      double s = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
      for (std::size_t j = 0; j < 4; ++j) {
        const float* const row = value.data() + at(first[0], first[1] + j, first[2] + k);
        const double a = static_cast<double>(row[0]), b = static_cast<double>(row[1]);
        const double c = static_cast<double>(row[2]), d = static_cast<double>(row[3]);
        const double r = wx.value[0] * a + wx.value[1] * b + wx.value[2] * c + wx.value[3] * d;
        const double rx = wx.slope[0] * a + wx.slope[1] * b + wx.slope[2] * c + wx.slope[3] * d;
        const double rxx = wx.bend[0] * a + wx.bend[1] * b + wx.bend[2] * c + wx.bend[3] * d;
        s += wy.value[j] * r;
        sx += wy.value[j] * rx;
        sxx += wy.value[j] * rxx;
        sy += wy.slope[j] * r;
        sxy += wy.slope[j] * rx;
        syy += wy.bend[j] * r;
      }
      v += wz.value[k] * s;
      vx += wz.value[k] * sx;
      vy += wz.value[k] * sy;
      vxx += wz.value[k] * sxx;
      vxy += wz.value[k] * sxy;
      vyy += wz.value[k] * syy;
      vz += wz.slope[k] * s;
      vxz += wz.slope[k] * sx;
      vyz += wz.slope[k] * sy;
      vzz += wz.bend[k] * s;
    }
    const double h1 = per_pitch, h2 = per_pitch * per_pitch;
    coarse_reading out;
    out.value_m = v;
    out.slope = {h1 * vx, h1 * vy, h1 * vz};
    out.hessian_per_m = {h2 * vxx, h2 * vxy, h2 * vxz, h2 * vxy, h2 * vyy, h2 * vyz, h2 * vxz, h2 * vyz, h2 * vzz};
    if (c_b != p_b) go_on_beyond(p_b - c_b, out);
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(value); }

 private:
  static void go_on_beyond(const vec3& beyond, coarse_reading& out) noexcept {
    const double away = std::sqrt(glm::dot(beyond, beyond));
    const vec3 n = beyond / away;
    for (int a = 0; a < 3; ++a) {
      const bool held = beyond[a] != 0.0;
      if (held) out.slope[a] = 0.0;
      for (int b = 0; b < 3; ++b) {
        if (held || beyond[b] != 0.0) out.hessian_per_m[b][a] = 0.0;
        if (held) out.hessian_per_m[b][a] -= ((a == b ? 1.0 : 0.0) - n[a] * n[b]) / away;
      }
    }
    out.value_m -= away;
    out.slope -= n;
  }
};

}  // namespace detail
}  // namespace asperity
