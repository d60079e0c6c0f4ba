// The CAD part: a plate with two steps, three round holes and a slot, rough as cast.
#include <array>

#include "lattice_solid.hpp"
#include "shapes.hpp"
#include "surface_relief.hpp"

namespace asperity::models {
namespace {

/// A round hole through the part along z. Within `outer` of its axis the lattice gives way to its circle.
struct round_hole {
  vec2 centre_m;
  double radius_m;
  double outer_m;
};

constexpr std::array<round_hole, 3> holes = {
    {{{-28e-3, 0.0}, 9e-3, 18e-3}, {{14e-3, -16e-3}, 5e-3, 9e-3}, {{14e-3, 16e-3}, 5e-3, 9e-3}}};

bool in_square(const vec3& p, const vec2& centre, double half_x, double half_y) {
  return std::abs(p.x - centre.x) < half_x && std::abs(p.y - centre.y) < half_y;
}

/// Plate 96 x 64 mm and 10 mm thick, with steps at 17 mm and 25 mm. Round holes are square here.
bool filled(const vec3& p) {
  for (const round_hole& hole : holes)
    if (in_square(p, hole.centre_m, hole.radius_m, hole.radius_m)) return false;
  if (in_square(p, {32e-3, 0.0}, 4e-3, 11e-3)) return false;  // the slot
  const double top = p.x < -8e-3 ? 25e-3 : (p.x < 4e-3 ? 17e-3 : 10e-3);
  return p.z < top - 12.5e-3;
}

vec3 with_round_holes(const vec3& p) {
  vec2 q(p.x, p.y);
  // The regions of the holes do not overlap: at most one of them moves q.
  for (const round_hole& hole : holes)
    q = hole.centre_m + square_to_disc(q - hole.centre_m, hole.radius_m, hole.outer_m);
  return {q.x, q.y, p.z};
}

}  // namespace

triangle_mesh make_cad_part() {
  // Cells of 0.25 mm throughout. The surface has 329,216 of their faces: 658,432 triangles.
  lattice_solid solid;
  solid.axes[0] = {{-48e-3, -37e-3, -19e-3, -8e-3, 4e-3, 9e-3, 19e-3, 28e-3, 36e-3, 48e-3},
                   {44, 72, 44, 48, 20, 40, 36, 32, 48}};
  solid.axes[1] = {{-32e-3, -21e-3, -11e-3, -9e-3, 9e-3, 11e-3, 21e-3, 32e-3}, {44, 40, 8, 72, 8, 40, 44}};
  solid.axes[2] = {{-12.5e-3, -2.5e-3, 4.5e-3, 12.5e-3}, {40, 28, 32}};
  solid.filled = filled;
  triangle_mesh mesh = surface_of(solid, with_round_holes);
  displace(mesh, 1e-3, band_noise(20041, 2e-3, 5e-3, 0.2e-3));
  return mesh;
}

}  // namespace asperity::models
