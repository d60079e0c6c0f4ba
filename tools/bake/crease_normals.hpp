// Directions in which the texels look for the original surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// A unit direction for every point of a coarse mesh, continuous over the whole surface.
/// Away from sharp edges it is the interpolation of normals that are averaged on one side of such edges only, so that a
/// large flat face is projected straight, as the depth lookup (orthographic) wants it. In a band along each sharp edge
/// it turns into the ordinary interpolated normal, which both sides of the edge share: no crack opens there. The band
/// is as wide as the original is far: where it has the same edge, the faces keep their direction up to it.
class crease_normals {
 public:
  /// @param least_band_m narrowest band: half a texel, for a texture cannot follow a faster turn
  /// @pre closed 2-manifold without degenerate triangles
  crease_normals(const triangle_mesh& coarse, const triangle_bvh& full, double least_band_m);

  /// @param b barycentric coordinates in triangle t; they may lie a little outside of it
  [[nodiscard]] vec3 at(std::uint32_t t, const std::array<double, 3>& b) const noexcept;

  [[nodiscard]] std::size_t sharp_edges() const noexcept { return sharp_edges_; }

 private:
  struct sharp_edge {
    std::array<vec3, 2> ends;
    double band_m;
  };

  [[nodiscard]] vec3 mix(const std::array<vec3, 3>& values, const std::array<double, 3>& b) const noexcept;

  std::size_t sharp_edges_ = 0;
  std::vector<std::array<vec3, 3>> corners_;
  std::vector<std::array<vec3, 3>> smooth_;     // corner normals over all faces around the vertex
  std::vector<std::array<vec3, 3>> one_sided_;  // corner normals up to the nearest sharp edges
  std::vector<std::uint32_t> first_near_;       // per triangle: its range of near_
  std::vector<sharp_edge> near_;                // those whose band reaches the triangle
};

}  // namespace asperity::bake
