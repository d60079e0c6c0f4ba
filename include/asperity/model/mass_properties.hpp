// Volume, centre of mass and inertia of a closed triangle mesh.
#pragma once

#include "asperity/core/math.hpp"
#include "asperity/model/coarse_mesh.hpp"

namespace asperity {

struct mass_properties {
  double volume_m3 = 0.0;
  vec3 centre_of_mass{0.0};    ///< body frame, metres
  mat3 inertia_per_mass{0.0};  ///< about the centre of mass, body axes, m^2 (multiply by the mass)
};

/// Mass properties of the solid that the mesh encloses, of uniform density, by summing signed tetrahedra.
/// @pre closed and outward oriented; otherwise volume_m3 is not positive and the rest means nothing
[[nodiscard]] inline mass_properties compute_mass_properties(const coarse_mesh& mesh) noexcept {
  mass_properties out;
  if (mesh.positions.empty()) return out;
  // Tetrahedra from a vertex instead of the origin: a mesh far from the origin keeps its digits.
  const vec3 apex = mesh.positions.front();
  double volume = 0.0;
  vec3 first{0.0};
  mat3 second{0.0};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    const vec3 a = c[0] - apex;
    const vec3 b = c[1] - apex;
    const vec3 d = c[2] - apex;
    const double v = glm::dot(a, glm::cross(b, d)) / 6.0;
    const vec3 s = a + b + d;
    volume += v;
    first += v / 4.0 * s;
    second += v / 20.0 *
              (glm::outerProduct(s, s) + glm::outerProduct(a, a) + glm::outerProduct(b, b) + glm::outerProduct(d, d));
  }
  out.volume_m3 = volume;
  if (!(volume > 0.0)) return out;
  const vec3 centre = first / volume;
  const mat3 covariance = second / volume - glm::outerProduct(centre, centre);
  out.centre_of_mass = apex + centre;
  out.inertia_per_mass = (covariance[0][0] + covariance[1][1] + covariance[2][2]) * mat3(1.0) - covariance;
  return out;
}

}  // namespace asperity
