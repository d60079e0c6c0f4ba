// The truth of the race: two original meshes at a pose, and the shortest translation that parts them. Found by their
// triangles alone, with the code of the tests' oracles; no contender has a part in it.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "law/oracle/placed_mesh.hpp"

namespace asperity::rivals {

/// What the originals say of a pose.
struct parting {
  double depth_m = 0.0;     ///< length of the shortest translation found that parts them
  vec3 n_ab_w{0.0};         ///< against it: from the probe into the fixed body, unit
  double at_least_m = 0.0;  ///< no motion shorter parts them: the deepest vertex of either body in the other
  /// The shortest found that points more than `elsewhere_rad` away from the shortest. Where it is hardly longer, the
  /// direction of the shortest means little.
  double elsewhere_m = std::numeric_limits<double>::infinity();
  std::size_t triangles = 0;  ///< of both surfaces, that such a short translation can bring together
};
inline constexpr double elsewhere_rad = 0.5235987755982988;  // 30 degrees

/// Two bodies at full resolution, the fixed one's frame the world.
class originals {
 public:
  /// @pre both closed, connected and outward oriented
  originals(const triangle_mesh& probe, const triangle_mesh& fixed);

  /// How far the probe can go down along -z until the surfaces touch, coming from above; negative where it is deeper
  /// than that, infinite where they pass each other by. Exact but for rounding.
  [[nodiscard]] double way_down_m(const pose& T_wa);

  /// The shortest translation that parts the two, searched over all directions within 100 degrees of straight up: the
  /// way out along a direction is exact, the direction is the best of a spread, each refined until nothing shorter is
  /// found beside it.
  /// @param at_most_m  length of one that is known to part them, straight up: T_wa was pressed down by so much
  [[nodiscard]] parting part(const pose& T_wa, double at_most_m);

  /// True where the surfaces cross with the probe moved by `shift_w`.
  [[nodiscard]] bool cross(const pose& T_wa, const vec3& shift_w);

 private:
  oracle::placed_mesh probe_, fixed_;
};

}  // namespace asperity::rivals
