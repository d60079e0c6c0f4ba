// Generalised winding number of any triangles, closed or not.
#pragma once

#include <array>
#include <vector>

#include "asperity/core/math.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// A point with at least this winding number is inside.
inline constexpr double inside_winding = 0.5;

/// How often a triangle soup winds about a point: 1 inside of a closed, outward oriented surface and 0 outside; between
/// them near holes; plus and minus one half at the two sides of a sheet. Refers to the tree.
/// @source Barill, Dickson, Schmidt, Levin and Jacobson 2018: far parts of the tree as a dipole and its first moment
class winding_field {
 public:
  explicit winding_field(const triangle_bvh& tree);

  /// Exact to about 0.002 far from the surface, to rounding near it.
  [[nodiscard]] double at(const vec3& p) const noexcept;

 private:
  // Area vectors of all triangles under a node, and their first moment about its centre: r' M r needs its symmetric part.
  struct moments {
    std::array<float, 3> centre{};
    float reach2 = 0.0F;  // square of the distance from which on they may be used
    std::array<float, 3> area{};
    std::array<float, 6> first{};  // xx yy zz, and xy + yx, xz + zx, yz + zy
  };

  const triangle_bvh& tree_;
  std::vector<moments> moments_;
};

/// Signed solid angle of a triangle seen from p, as a share of the full sphere: -1/2 to 1/2.
/// @source van Oosterom and Strackee 1983
[[nodiscard]] double winding_of(const std::array<vec3, 3>& c, const vec3& p) noexcept;

}  // namespace asperity::bake
