// Generalised winding number of any triangles, closed or not.
#pragma once

#include <array>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// A point with at least this winding number is inside.
inline constexpr double inside_winding = 0.5;

/// How often a triangle soup winds about a point: 1 inside of a closed, outward oriented surface and 0 outside; between
/// them near holes; plus and minus one half at the two sides of a sheet. Refers to the tree.
/// @source Barill, Dickson, Schmidt, Levin and Jacobson 2018: far parts of the tree as a dipole and two moments of it
class winding_field {
 public:
  explicit winding_field(const triangle_bvh& tree);

  /// Within 0.005 of the exact sum, in the median within 0.0005.
  [[nodiscard]] double at(const vec3& p) const noexcept;

 private:
  // What the triangles under a node are like from afar: r is from the point to the node's centre, d from there on.
  struct moments {
    std::array<float, 3> centre{};
    float reach2 = 0.0F;            // square of the distance from which on they may be used
    std::array<float, 3> area{};    // sum of n
    std::array<float, 6> first{};   // r' (sum of d n') r: x^2 y^2 z^2, xy, xz, yz
    std::array<float, 3> linear{};  // sum of 2 d (d.n) + d.d n
    std::array<float, 10> cubic{};  // (r.d)^2 (r.n): x^3 y^3 z^3, x^2 y, x^2 z, y^2 x, y^2 z, z^2 x, z^2 y, xyz
  };

  const triangle_bvh& tree_;
  std::vector<moments> moments_;
};

/// The same surface with triangles cut in two at their longest edge until none is longer than a 32nd of the diagonal, or
/// than what keeps the new ones below a million. Long triangles make every part of a tree large, and all of them near.
[[nodiscard]] triangle_mesh without_long_triangles(const triangle_mesh& mesh);

/// Signed solid angle of a triangle seen from p, as a share of the full sphere: -1/2 to 1/2.
/// @source van Oosterom and Strackee 1983
[[nodiscard]] double winding_of(const std::array<vec3, 3>& c, const vec3& p) noexcept;

}  // namespace asperity::bake
