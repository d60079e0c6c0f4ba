#include "bake/solid.hpp"

#include <cmath>
#include <numbers>

#include "bake/geometry.hpp"

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

// Winding number of the mesh about p, from the solid angles of its triangles (van Oosterom and Strackee, 1983).
bool solid::winds_around(const vec3& p) const noexcept {
  double angle = 0.0;
  for (const index_triangle& t : mesh_.triangles) {
    const auto c = corners(mesh_.positions, t);
    const vec3 a = c[0] - p;
    const vec3 b = c[1] - p;
    const vec3 d = c[2] - p;
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double ld = glm::length(d);
    angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, d)),
                              la * lb * ld + glm::dot(a, b) * ld + glm::dot(b, d) * la + glm::dot(d, a) * lb);
  }
  return angle > 2.0 * std::numbers::pi;
}

}  // namespace asperity::bake
