// What a depth backend reports for one contact.
#pragma once

#include <cstdint>

#include "asperity/core/spatial.hpp"

namespace asperity {

/// Flags of a penetration. Anything set is worth showing to the person who sets the scene up.
enum class depth_flag : std::uint8_t {
  none = 0,
  no_overlap = 1,        ///< no sample where both patches exist: depth and gradient are zero and mean nothing
  window_too_small = 2,  ///< the deepest sample lies on the window's border
  saturated = 4,         ///< the depth left the range that the backend can express
  bad_texel = 8,         ///< a NaN texel was met and its samples were left out
  unresolved = 16,       ///< a search stopped at its limit: the largest depth may be larger than what it found
};

[[nodiscard]] constexpr depth_flag operator|(depth_flag a, depth_flag b) noexcept {
  return static_cast<depth_flag>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr depth_flag& operator|=(depth_flag& a, depth_flag b) noexcept { return a = a | b; }
[[nodiscard]] constexpr bool has(depth_flag set, depth_flag bit) noexcept {
  return (static_cast<std::uint8_t>(set) & static_cast<std::uint8_t>(bit)) != 0;
}

/// Directional penetration depth of one contact and its derivatives by a motion of the probe.
struct penetration {
  double depth_m = 0.0;       ///< max(h_A - h_B) over the window (paper, Eq. 9); > 0 means overlap, < 0 a gap
  double soft_depth_m = 0.0;  ///< the depth that `gradient` is the gradient of; equals depth_m for central difference
  vec6 gradient{};            ///< d soft_depth / d(translation of c_A; rotation about c_A), world axes; m/m and m/rad
  mat6 curvature{};           ///< second derivative, positive semidefinite, same axes; zero for central difference
  vec3 witness_w{0.0};        ///< point of A's fine surface at the deepest sample, world
  double area_m2 = 0.0;       ///< area, across n, where both patches exist
  std::uint32_t samples = 0;  ///< samples in that area
  depth_flag flags = depth_flag::none;
};

}  // namespace asperity
