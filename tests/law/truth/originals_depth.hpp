// How deep two original meshes are in each other along a direction, near one place: exactly, by their triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::truth {

/// A mesh whose triangles can be asked for by place. None of the library's code has a part in it.
class near_triangles {
 public:
  explicit near_triangles(const triangle_mesh& mesh);

  /// Every triangle whose box meets the ball, body frame, each once, in the order of their numbers.
  void collect(const vec3& centre_b, double radius_m, std::vector<std::uint32_t>& out) const;
  /// Distance from a point to the nearest triangle whose box is within `at_most_m`; `at_most_m` where there is none.
  [[nodiscard]] double distance(const vec3& p_b, double at_most_m) const;
  /// By how much a triangle within the ball looks aside from their mean normal, at most, rad; pi where there is none.
  [[nodiscard]] double turn_rad(const vec3& centre_b, double radius_m) const;
  [[nodiscard]] const triangle_mesh& mesh() const noexcept { return *mesh_; }

 private:
  [[nodiscard]] std::array<std::size_t, 3> cell_of(const vec3& p_b) const noexcept;

  const triangle_mesh* mesh_;
  vec3 low_{0.0};
  double cell_m_ = 1.0;
  std::array<std::size_t, 3> cells_{};
  std::vector<std::vector<std::uint32_t>> in_cell_;
};

/// Where the two surfaces are asked about: balls about a point of the probe's surface and one of the fixed body's.
struct asked_place {
  vec3 point_a_w{0.0}, point_b_w{0.0};
  vec3 n_ab_w{0.0};       ///< unit
  double radius_m = 0.0;  ///< of both balls
};

/// What the originals say there.
struct place_depth {
  bool found = false;       ///< a line along n meets both surfaces within the balls
  double depth_m = 0.0;     ///< the largest of (highest point of A) - (lowest point of B), along n
  double at_place_m = 0.0;  ///< the same on the nearest such line to the asked points: their own, if there is one
  double aside_m = 0.0;     ///< how far that line is from them
  vec3 out_a_w{0.0}, out_b_w{0.0};  ///< mean normals of the surfaces within half the balls, by area; unit
};

/// The directional penetration depth of the two originals along n near a place: over all lines along n on which A's
/// surface lies in the one ball and B's in the other. Vertices against faces and edges across edges, none left out; and
/// points of a polar grid, for lines where a ball ends.
[[nodiscard]] place_depth depth_near(const near_triangles& a, const pose& T_wa, const near_triangles& b,
                                     const pose& T_wb, const asked_place& at);

}  // namespace asperity::truth
