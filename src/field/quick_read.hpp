// The smooth part of a depth field in single precision: it decides which samples need an exact reading.
#pragma once

#include <cmath>
#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/field/coarse_grid.hpp"
#include "field/lanes.hpp"

namespace asperity::detail {

/// A smooth part with its derivatives, with an error bound.
struct quick_reading {
  coarse_reading at;
  double error_m = 0.0;  ///< value and relief differ by less from exact readings
};

/// Whether a quick reading has second derivatives as well.
enum class quick_part { slope, bend };

/// A third of the cost of coarse_grid::read(): four nodes in a row are one register, on every processor. Single
/// precision is wrong by 6e-8 of what is added, and nodes next to a point differ from its value by a few pitches at
/// most: error_m allows for a hundred times that. Without `bend`, second derivatives are zero.
/// @rt safe: 64 nodes
template <quick_part part>
[[nodiscard]] inline quick_reading quick_read(const coarse_grid& of, const vec3& p_b) noexcept {
  const vec3 c_b = of.clamped(p_b);
  quick_reading out;
  if (c_b != p_b) {
    out.at = of.read(p_b);
    return out;
  }
  const cubic_nodes nodes = of.nodes_of(of.cell_of(c_b));
  // The three axes side by side.
  const lanes f{static_cast<float>(nodes.f[0]), static_cast<float>(nodes.f[1]), static_cast<float>(nodes.f[2]), 0.0F};
  const lanes g = 1.0F - f;
  const lanes value[4] = {g * g * g * (1.0F / 6.0F), 2.0F / 3.0F + f * f * (0.5F * f - 1.0F),
                          2.0F / 3.0F + g * g * (0.5F * g - 1.0F), f * f * f * (1.0F / 6.0F)};
  const lanes slope[4] = {-0.5F * g * g, f * (1.5F * f - 2.0F), g * (2.0F - 1.5F * g), 0.5F * f * f};
  const lanes bend[4] = {g, 3.0F * f - 2.0F, 3.0F * g - 2.0F, f};
  lanes v{}, by_y{}, by_z{}, by_yy{}, by_yz{}, by_zz{};
  for (std::size_t k = 0; k < 4; ++k) {
    lanes layer{}, layer_by_y{}, layer_by_yy{};
    for (std::size_t j = 0; j < 4; ++j) {
      const lanes row = load_lanes(nodes.at(j, k));
      layer += value[j][1] * row;
      layer_by_y += slope[j][1] * row;
      if constexpr (part == quick_part::bend) layer_by_yy += bend[j][1] * row;
    }
    v += value[k][2] * layer;
    by_y += value[k][2] * layer_by_y;
    by_z += slope[k][2] * layer;
    if constexpr (part == quick_part::bend) {
      by_yy += value[k][2] * layer_by_yy;
      by_yz += slope[k][2] * layer_by_y;
      by_zz += bend[k][2] * layer;
    }
  }
  const auto along_x = [](const lanes(&weight)[4], const lanes& sums) noexcept {
    const lanes weights{weight[0][0], weight[1][0], weight[2][0], weight[3][0]};
    return static_cast<double>(sum_of(weights * sums));
  };
  const double per_pitch = nodes.per_pitch;
  out.at.value_m = along_x(value, v);
  out.at.slope = per_pitch * vec3(along_x(slope, v), along_x(value, by_y), along_x(value, by_z));
  if constexpr (part == quick_part::bend) {
    const double xy = along_x(slope, by_y), xz = along_x(slope, by_z), yz = along_x(value, by_yz);
    out.at.hessian_per_m = per_pitch * per_pitch *
                           mat3(along_x(bend, v), xy, xz, xy, along_x(value, by_yy), yz, xz, yz, along_x(value, by_zz));
  }
  constexpr double of_what_is_added = 1e-5;
  out.error_m = of_what_is_added * (std::fabs(out.at.value_m) + 4.0 * of.pitch_m);
  return out;
}

}  // namespace asperity::detail
