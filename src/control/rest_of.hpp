// Where springs and planes balance, and what that is measured in.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

namespace detail {

/// How far planes are followed from where they were reported: further off they are too wrong.
inline constexpr double furthest_rest_m = 1e-4, furthest_rest_rad = 5e-3;
/// How many such ways a pose of rest may be from the probe's: as far as one that slides off an edge comes in two
/// periods of a slow contact loop.
inline constexpr double most_ways = 5.0;

/// The length of a motion, in those of furthest_rest_m and furthest_rest_rad.
[[nodiscard]] inline double share_of_furthest(const vec6& way) noexcept {
  return std::max(std::sqrt(glm::dot(way.linear, way.linear)) / furthest_rest_m,
                  std::sqrt(glm::dot(way.angular, way.angular)) / furthest_rest_rad);
}

/// Where springs and planes balance, as a motion from the pose where both were reported, of at most half a millimetre
/// and 25 mrad.
[[nodiscard]] inline vec6 rest_of(const coupling_pull& pull, std::span<const support_plane> planes,
                                  const contact_laws& laws = {}) noexcept {
  mat6 springs;
  for (std::size_t i = 0; i < 6; ++i) springs(i, i) = i < 3 ? pull.stiffness_n_per_m : pull.stiffness_n_m_per_rad;
  const vec6 way = way_to_balance(springs, to_vec6(pull.on_probe_w), planes, laws).value_or(vec6{});
  const double ways = share_of_furthest(way);
  return ways > most_ways ? (most_ways / ways) * way : way;
}

/// Whether two planes stand for one point of a surface.
[[nodiscard]] inline bool same_point(const support_plane& p, const support_plane& q) noexcept {
  constexpr double same_sample_m = 2e-5;  // a sample turns with the probe by less than this
  if (p.body != q.body) return false;
  if (p.sample != 0 && q.sample != 0) return p.sample == q.sample;
  const vec3 apart = q.r_w - p.r_w;
  return glm::dot(apart, apart) < same_sample_m * same_sample_m;
}

}  // namespace detail

}  // namespace asperity
