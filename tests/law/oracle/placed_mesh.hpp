// A full-resolution mesh at a pose, with the few exact questions that the oracles ask of two of them: when do they
// touch along z, how far are they apart, how deep is one's deepest vertex in the other. None of the library's code for
// collisions, depths or bakes has a part in the answers.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::oracle {

/// Where two meshes meet first, and how far one has to go until then.
struct first_touch {
  double way_m = std::numeric_limits<double>::infinity();  ///< infinite where they pass each other by
  vec3 point{0.0};                                         ///< on the mesh that is met
  /// Out of the mesh that is met, unit, by the features that touch: the face's normal where a vertex meets a face, the
  /// cross product where two edges meet. Zero where nothing touches.
  vec3 normal{0.0};
};

/// Triangles in a tree of boxes. The tree is cut once, in the body's frame; place() moves it.
class placed_mesh {
 public:
  /// @pre mesh has triangles
  explicit placed_mesh(const triangle_mesh& mesh);

  /// Takes every vertex p to rotation * p + shift.
  void place(const quat& rotation, const vec3& shift);

  /// Distance to the surface. At most `at_most`, which cuts the search short.
  [[nodiscard]] double distance_to(const vec3& p,
                                   double at_most = std::numeric_limits<double>::infinity()) const noexcept;
  /// True inside the closed surface: lines along z, and along x and y where a line may have run along an edge.
  [[nodiscard]] bool contains(const vec3& p) const noexcept;
  /// Highest crossing of the line through (x, y) along z; minus infinity where there is none.
  [[nodiscard]] double highest(double x, double y) const noexcept { return crossing(x, y, 1.0); }
  /// Lowest crossing; infinity where there is none.
  [[nodiscard]] double lowest(double x, double y) const noexcept { return crossing(x, y, -1.0); }

  /// Distance from p along a unit direction to the first crossing that is farther than `beyond`; infinite where there
  /// is none.
  [[nodiscard]] double crossing_along(const vec3& p, const vec3& direction, double beyond) const noexcept;

  [[nodiscard]] const std::vector<vec3>& points() const noexcept { return points_; }
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const noexcept { return triangles_; }

  /// How far `a` can go along +z before it touches `b`, coming from z = -infinity: the least over all lines along z of
  /// b's lowest minus a's highest point. Exact but for rounding: all pairs of vertex and face, and of edges.
  friend first_touch touch_along_z(const placed_mesh& a, const placed_mesh& b) noexcept;
  /// Distance of two surfaces that do not cross, with `a` moved by `shift_z` along z. At most `at_most`.
  friend double surface_distance(const placed_mesh& a, const placed_mesh& b, double shift_z, double at_most) noexcept;
  /// Whether any two triangles of the two surfaces cross, with `a` moved by `shift`. Coplanar ones do not count.
  friend bool surfaces_cross(const placed_mesh& a, const placed_mesh& b, const vec3& shift) noexcept;
  /// Largest distance to b's surface of all vertices of `a`, moved by `shift` and inside b; 0 where none is inside.
  friend double deepest_vertex(const placed_mesh& a, const placed_mesh& b, const vec3& shift) noexcept;

 private:
  struct node {
    vec3 low{0.0}, high{0.0};
    std::uint32_t first = 0, count = 0;  ///< triangles of a leaf; count 0: an inner node
    std::uint32_t right = 0;             ///< its left child follows it
  };
  [[nodiscard]] std::uint32_t cut(std::uint32_t first, std::uint32_t count, std::vector<vec3>& centres);
  [[nodiscard]] std::array<vec3, 3> corners_of(std::uint32_t t) const noexcept {
    const auto& v = triangles_[t];
    return {points_[v[0]], points_[v[1]], points_[v[2]]};
  }
  /// Tells found(coordinate) of every triangle that the line through p along `axis` crosses, in nodes that misses()
  /// does not rule out.
  template <class Misses, class Found>
  void each_crossing(const vec3& p, int axis, const Misses& misses, const Found& found) const noexcept;
  [[nodiscard]] double crossing(double x, double y, double sign) const noexcept;
  [[nodiscard]] int crossings_beyond(const vec3& p, int axis) const noexcept;

  std::vector<vec3> rest_, points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< in the order of the leaves
  std::vector<node> nodes_;
};

[[nodiscard]] first_touch touch_along_z(const placed_mesh& a, const placed_mesh& b) noexcept;
[[nodiscard]] double surface_distance(const placed_mesh& a, const placed_mesh& b, double shift_z,
                                      double at_most) noexcept;
[[nodiscard]] bool surfaces_cross(const placed_mesh& a, const placed_mesh& b, const vec3& shift) noexcept;
[[nodiscard]] double deepest_vertex(const placed_mesh& a, const placed_mesh& b, const vec3& shift) noexcept;

/// How deep two bodies are in each other, from below: no motion shorter than this takes them apart.
/// @param shift_z by which `a` is moved along z
[[nodiscard]] inline double overlap_at_least(const placed_mesh& a, const placed_mesh& b, double shift_z) noexcept {
  const vec3 shift(0.0, 0.0, shift_z);
  const double mine = deepest_vertex(a, b, shift), its = deepest_vertex(b, a, -shift);
  return mine > its ? mine : its;
}

}  // namespace asperity::oracle
