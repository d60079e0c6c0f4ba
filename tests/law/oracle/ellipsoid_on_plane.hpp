// The ellipsoid over a plane (O7), as a textured plate that carries the part of it about its lowest point.
#pragma once

#include <cmath>
#include <cstdint>

#include "law/oracle/closed_forms.hpp"

namespace asperity::oracle {

struct ellipsoid_on_plane {
  vec3 axes;    ///< semi-axes, mm
  vec3 lowest;  ///< its lowest point, mm, world
  scene bodies;
  pose T_wa;  ///< the probe's frame is the ellipsoid's own
};

/// @param half_mm  half the side of the plate, of `texels` x `texels` texels
[[nodiscard]] inline ellipsoid_on_plane make_ellipsoid_on_plane(const json& c, double half_mm, std::uint32_t texels) {
  using namespace test_support;
  ellipsoid_on_plane out{vector_of(c["semi_axes"]), vector_of(c["witness"]), {}, {}};
  const vec3 axes = out.axes, centre = vector_of(c["centre"]), lowest = out.lowest;
  const quat R = exp_rotation(vector_of(c["rotvec"]));
  // Lower surface over (x, y) by the quadratic x^T S x = 1; beyond the silhouette something that does not touch.
  const mat3 Rm = glm::mat3_cast(R);
  const mat3 S = Rm *
                 mat3(1.0 / (axes.x * axes.x), 0, 0, 0, 1.0 / (axes.y * axes.y), 0, 0, 0, 1.0 / (axes.z * axes.z)) *
                 glm::transpose(Rm);
  const auto below_lowest = [=](double x, double y) {
    const vec3 d(x + lowest.x - centre.x, lowest.y - centre.y - y, 0.0);  // the plate's y points to -y in the world
    const double qa = S[2][2], qb = S[2][0] * d.x + S[2][1] * d.y;
    const double qc = S[0][0] * d.x * d.x + 2.0 * S[0][1] * d.x * d.y + S[1][1] * d.y * d.y - 1.0;
    const double root = qb * qb - qa * qc;
    return root > 0.0 ? lowest.z - centre.z + (qb + std::sqrt(root)) / qa : -1.0;
  };
  plate_spec probe = plate_mm(half_mm, texels, below_lowest);
  out.T_wa = {R, mm * centre};
  const pose T_w_plate{face_down(), mm * lowest};
  probe.T_body_plate = inverse(out.T_wa) * T_w_plate;
  probe.centre_of_mass = inverse(T_w_plate) * out.T_wa.position;
  out.bodies = {make_plate(probe), {make_plate(plate_mm(8.0, 64, {}))}};
  return out;
}

}  // namespace asperity::oracle
