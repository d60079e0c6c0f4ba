// Convex hull of a growing set of points, exact on a fine lattice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/textured_model.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {

/// Points on a lattice of 2^25 steps across a box: a step is 3e-8 of the box's longest side. Orientation tests on it
/// are exact in integers, so that coplanar and nearly flat sets need no tolerance and cannot break the hull.
struct lattice_point {
  std::int64_t x = 0, y = 0, z = 0;
  friend bool operator==(const lattice_point&, const lattice_point&) = default;
};

[[nodiscard]] std::vector<lattice_point> to_lattice(std::span<const vec3> points, const bounds& box);

/// Hull of some of the points of a lattice, made point by point. Copyable: try a point on a copy.
class convex_hull {
 public:
  /// @pre the lattice outlives the hull
  explicit convex_hull(std::span<const lattice_point> lattice) : lattice_(lattice) {}

  /// Takes point v of the lattice in. Cost: linear in the number of faces.
  void insert(std::uint32_t v);

  /// True once the points do not all lie in one plane; faces() is empty before that.
  [[nodiscard]] bool is_solid() const noexcept { return !faces_.empty(); }

  /// Faces, counter-clockwise from outside, as indices into the lattice. Facets with more corners come as several
  /// faces.
  [[nodiscard]] const std::vector<index_triangle>& faces() const noexcept { return faces_; }

 private:
  void begin_solid();
  void extend(std::uint32_t v);

  std::span<const lattice_point> lattice_;
  std::vector<std::uint32_t> waiting_;  // points taken while all of them lie in one plane
  std::vector<std::uint32_t> frame_;    // affinely independent ones among them: at most 4
  std::vector<index_triangle> faces_;
};

/// Corners of the convex hull of points in a plane, counter-clockwise seen against `normal`, as indices into `points`;
/// points on its edges are left out. Fewer than 3 where the points lie on a line. @pre |normal| = 1
[[nodiscard]] std::vector<std::uint32_t> convex_polygon(std::span<const vec3> points, const vec3& normal);

}  // namespace asperity::bake
