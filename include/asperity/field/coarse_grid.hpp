// The smooth part of a body's depth field: a dense grid that a cubic B-spline reads.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/cubic_nodes.hpp"

namespace asperity {

namespace detail {

/// Signed distances at nodes, read as coefficients of a cubic B-spline: continuous with two derivatives. With values of
/// a function as its coefficients a B-spline smooths the function over a pitch, which the smooth part needs.
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
      // std::max comes first because it makes a number of a NaN: an index is computed from the result.
      out[k] = std::min(std::max(low[k] + pitch_m, p_b[k]), low[k] + last * pitch_m);
    }
    return out;
  }

  /// Value of the node next to a point plus how far off it is: an upper bound of the distance there. @rt safe
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

  /// The cell of a point within the grid: its first node, and the place in it, 0 to 1 along each axis. @rt safe
  struct cell_place {
    std::array<std::size_t, 3> cell;
    double f[3];
  };
  [[nodiscard]] cell_place cell_of(const vec3& clamped_b) const noexcept {
    cell_place out;
    const double per_pitch = 1.0 / pitch_m;
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (clamped_b[axis] - low[axis]) * per_pitch;
      out.cell[k] = static_cast<std::size_t>(std::min(std::max(1.0, g), static_cast<double>(nodes[k]) - 3.0));
      out.f[k] = g - static_cast<double>(out.cell[k]);
    }
    return out;
  }
  /// The nodes about a place.
  [[nodiscard]] cubic_nodes nodes_of(const cell_place& at_place) const noexcept {
    const auto& [cell, f] = at_place;
    return {value.data() + at(cell[0] - 1, cell[1] - 1, cell[2] - 1),
            nodes[0],
            nodes[0] * nodes[1],
            {f[0], f[1], f[2]},
            1.0 / pitch_m};
  }

  /// The spline. Beyond the grid: its value at the border less the distance from there, continuous and falling.
  /// @rt safe: 64 nodes
  [[nodiscard]] coarse_reading read(const vec3& p_b) const noexcept {
    const vec3 c_b = clamped(p_b);
    coarse_reading out = nodes_of(cell_of(c_b)).read();
    if (c_b != p_b) go_on_beyond(p_b - c_b, out);
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(value); }

  /// Its value alone, m, at a third of the cost. @rt safe
  [[nodiscard]] double value_m(const vec3& p_b) const noexcept {
    const vec3 c_b = clamped(p_b);
    const double at_c = nodes_of(cell_of(c_b)).value_m();
    return c_b == p_b ? at_c : at_c - glm::length(p_b - c_b);
  }

  /// Turns a reading at the border into one beyond it.
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
