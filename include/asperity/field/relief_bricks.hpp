// The fine part of a body's depth field: small bricks of nodes along the surface, which a quadratic B-spline reads.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/bspline.hpp"

namespace asperity::detail {

/// A function that is zero away from a surface: coefficients of a quadratic B-spline in bricks of 4 x 4 x 4 nodes.
/// Continuous with its slope everywhere. Where no brick is, the coefficients are zero.
struct relief_bricks {
  static constexpr std::size_t side = 4;
  static constexpr std::size_t nodes_per_brick = side * side * side;
  using brick = std::array<float, nodes_per_brick>;

  vec3 low{0.0};  ///< the first node, body frame
  double pitch_m = 1.0;
  std::array<std::size_t, 3> bricks_along{};  ///< bricks of the box; at least 1 each
  std::vector<std::uint32_t> index;           ///< into bricks, x fastest; 0 where there is none
  std::vector<brick> bricks;                  ///< the first holds zeros

  /// Where a spline's 27 nodes lie.
  struct place {
    std::array<std::uint32_t, 8> brick;     ///< by which of two neighbours in x, y, z (bits 0, 1, 2)
    std::array<std::uint8_t, 3> beyond[3];  ///< per axis and node: 0 or the neighbour's bit
    std::array<std::uint8_t, 3> offset[3];  ///< per axis and node: within the brick
    double f[3];                            ///< from the middle node, in units of the pitch
  };

  /// False beyond the box, where the function is zero. @rt safe
  [[nodiscard]] bool find(const vec3& p_b, place& out) const noexcept {
    std::size_t first_brick[3], last_brick[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (p_b[axis] - low[axis]) / pitch_m + 0.5;
      if (!(g >= 1.0 && g < static_cast<double>(side * bricks_along[k]) - 1.0)) return false;
      const auto middle = static_cast<std::size_t>(g);
      out.f[k] = g - 0.5 - static_cast<double>(middle);
      first_brick[k] = (middle - 1) / side;
      last_brick[k] = (middle + 1) / side;
      const std::size_t step = k == 0 ? 1 : (k == 1 ? side : side * side);
      for (std::size_t n = 0; n < 3; ++n) {
        const std::size_t node = middle + n - 1;
        out.beyond[k][n] = static_cast<std::uint8_t>(node / side == first_brick[k] ? 0U : 1U << k);
        out.offset[k][n] = static_cast<std::uint8_t>(node % side * step);
      }
    }
    for (std::size_t b = 0; b < 8; ++b) {
      const std::size_t x = (b & 1U) != 0 ? last_brick[0] : first_brick[0];
      const std::size_t y = (b & 2U) != 0 ? last_brick[1] : first_brick[1];
      const std::size_t z = (b & 4U) != 0 ? last_brick[2] : first_brick[2];
      out.brick[b] = index[(z * bricks_along[1] + y) * bricks_along[0] + x];
    }
    return true;
  }

  /// Calls visit(brick, node in it, weight) for the 27 nodes of a place.
  template <class Visit>
  static void for_each_node(const place& at, Visit&& visit) noexcept {
    const quadratic_weights wx(at.f[0]), wy(at.f[1]), wz(at.f[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        const double w = wz.value[k] * wy.value[j];
        const unsigned beyond = at.beyond[2][k] + at.beyond[1][j];
        const unsigned offset = at.offset[2][k] + at.offset[1][j];
        for (std::size_t i = 0; i < 3; ++i) {
          visit(at.brick[beyond + at.beyond[0][i]], static_cast<std::size_t>(offset + at.offset[0][i]),
                w * wx.value[i]);
        }
      }
    }
  }

  struct reading {
    double value = 0.0;
    vec3 slope{0.0};
  };

  /// The spline. @rt safe: 27 nodes
  [[nodiscard]] reading read(const vec3& p_b) const noexcept {
    reading out;
    place at;
    if (!find(p_b, at)) return out;
    const quadratic_weights wx(at.f[0]), wy(at.f[1]), wz(at.f[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        const unsigned beyond = at.beyond[2][k] + at.beyond[1][j];
        const unsigned offset = at.offset[2][k] + at.offset[1][j];
        double v = 0.0, vx = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
          const double c = static_cast<double>(bricks[at.brick[beyond + at.beyond[0][i]]][offset + at.offset[0][i]]);
          v += wx.value[i] * c;
          vx += wx.slope[i] * c;
        }
        out.value += wz.value[k] * wy.value[j] * v;
        out.slope += vec3(wz.value[k] * wy.value[j] * vx, wz.value[k] * wy.slope[j] * v, wz.slope[k] * wy.value[j] * v);
      }
    }
    out.slope /= pitch_m;
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(index, bricks); }
};

}  // namespace asperity::detail
