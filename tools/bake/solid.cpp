#include "bake/solid.hpp"

#include <cmath>

#include "bake/geometry.hpp"
#include "bake/winding_number.hpp"

namespace asperity::bake {

solid::solid(const triangle_mesh& mesh) : mesh_(mesh), tree_(mesh.positions, mesh.triangles) {
  normals_.reserve(mesh.triangles.size());
  for (const index_triangle& t : mesh.triangles) normals_.push_back(unit_normal(corners(mesh.positions, t)));
}

// Where the nearest point lies within a triangle, the side of that triangle tells; at edges and corners the winding
// number does, which costs a look at every triangle.
bool solid::holds(const vec3& p) const noexcept {
  const auto nearest = tree_.closest(p);
  const double height = glm::dot(normals_[nearest.triangle], p - nearest.point);
  return std::abs(height) > (1.0 - 1e-12) * nearest.distance_m ? height < 0.0 : winds_around(p);
}

bool solid::winds_around(const vec3& p) const noexcept {
  double winding = 0.0;
  for (const index_triangle& t : mesh_.triangles) winding += winding_of(corners(mesh_.positions, t), p);
  return winding > inside_winding;
}

}  // namespace asperity::bake
