// The 64 nodes of a cubic B-spline about a point, and its value and derivatives there.
#pragma once

#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/field/bspline.hpp"

namespace asperity {

/// Smooth signed distance at a point, with its first and second derivatives. Body frame, positive inside.
struct coarse_reading {
  double value_m = 0.0;
  vec3 slope{0.0};          ///< by the point's position
  mat3 hessian_per_m{0.0};  ///< symmetric
};

namespace detail {

/// Four nodes along each axis, the cell between the second and the third, and a place in it.
struct cubic_nodes {
  const float* first = nullptr;    ///< the node with the smallest x, y and z; x fastest
  std::size_t row = 0, layer = 0;  ///< how far apart neighbours along y and z are stored
  double f[3] = {};                ///< the place in the cell, 0 to 1
  double per_pitch = 1.0;          ///< 1/m

  [[nodiscard]] const float* at(std::size_t j, std::size_t k) const noexcept { return first + k * layer + j * row; }

  /// The spline's value, m. @rt safe
  [[nodiscard]] double value_m() const noexcept {
    const cubic_weights wx(f[0]), wy(f[1]), wz(f[2]);
    double v = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      double s = 0.0;
      for (std::size_t j = 0; j < 4; ++j) {
        const float* const along = at(j, k);
        s += wy.value[j] * (wx.value[0] * static_cast<double>(along[0]) + wx.value[1] * static_cast<double>(along[1]) +
                            wx.value[2] * static_cast<double>(along[2]) + wx.value[3] * static_cast<double>(along[3]));
      }
      v += wz.value[k] * s;
    }
    return v;
  }

  /// Its value and derivatives, at three times the cost. @rt safe
  [[nodiscard]] coarse_reading read() const noexcept {
    const cubic_weights wx(f[0]), wy(f[1]), wz(f[2]);
    double v = 0.0, vx = 0.0, vy = 0.0, vz = 0.0, vxx = 0.0, vxy = 0.0, vyy = 0.0, vxz = 0.0, vyz = 0.0, vzz = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      double s = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
      for (std::size_t j = 0; j < 4; ++j) {
        const float* const along = at(j, k);
        const double a = static_cast<double>(along[0]), b = static_cast<double>(along[1]);
        const double c = static_cast<double>(along[2]), d = static_cast<double>(along[3]);
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
    return out;
  }
};

}  // namespace detail
}  // namespace asperity
