// What one cell, or one pair of sharp edges, adds to the potential of a body pair.
#pragma once

#include <cstdint>

#include "asperity/core/spatial.hpp"

namespace asperity {

/// Sums over the samples of one cell, with their derivatives by a motion of the probe (translation of c_A; rotation
/// about c_A), world axes.
///
/// With e the effective depth of a sample, w its weight (an area) and tau the softness of the maximum:
///
///     mass    = sum w exp((e - reference) / tau)      reference: the largest e, so that nothing overflows
///     moment  = sum w e exp((e - reference) / tau)    moment / mass is the Boltzmann mean of the depth
///     overlap = sum w max(e, 0)^2                     decides the share of the spring
///
/// All three add up, which is why cutting a surface into more cells of the same direction changes nothing.
struct cell_reading {
  std::uint32_t body = 0;
  std::uint32_t samples = 0;  ///< with weight
  vec3 n_ab_w{0.0};           ///< unit, from A to B, world
  mat3 turn{0.0};             ///< d n_ab / d(rotation of the probe)
  double reference_m = 0.0;
  double mass = 0.0, moment = 0.0, overlap = 0.0;
  vec6 mass_slope{}, moment_slope{}, overlap_slope{};
  vec6 slope_sum{};       ///< sum of w exp() times the slope of e
  mat6 slope_product{};   ///< the same with the slope's outer product: spread of slopes, for the stiffness
  double depth_m = 0.0;   ///< largest effective depth; may be negative
  vec3 witness_w{0.0};    ///< that sample, world
  vec3 centre_w{0.0};     ///< mean of the samples, weighted as in mass
  double spread_m = 0.0;  ///< root mean square distance from it
  double area_m2 = 0.0;   ///< of the samples that overlap
  bool too_deep = false;  ///< a sample lies deeper than the cell's depth limit: it has faded to nothing
};

}  // namespace asperity
