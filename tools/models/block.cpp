// The textured block: straight ridges along x on top and bottom, flat sides.
#include <cmath>

#include "benchmark_models.hpp"
#include "lattice_solid.hpp"
#include "shapes.hpp"

namespace asperity::models {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr double half_x = 0.5 * block_size_m[0];
constexpr double half_y = 0.5 * block_size_m[1];
constexpr double half_z = 0.5 * block_size_m[2];

/// Top and bottom move together, up and down. So the top of one block fits the bottom of another one above it.
vec3 with_ridges(const vec3& p) {
  if (std::abs(p.z) < half_z) return p;
  const double share = smoothstep((half_x - std::abs(p.x)) / ridge_fade_m);
  return p + vec3(0.0, 0.0, share * ridge_amplitude_m * std::cos(two_pi / ridge_wavelength_m * p.y));
}

}  // namespace

triangle_mesh make_block() {
  // 32 cells to a ridge across y, few along x. 36 x 304 + 304 x 16 + 16 x 36 cells, twice, two triangles each: 65,536.
  lattice_solid solid;
  solid.axes[0] = {{-half_x, -half_x + ridge_fade_m, half_x - ridge_fade_m, half_x}, {4, 28, 4}};
  solid.axes[1] = {{-half_y, half_y}, {304}};
  solid.axes[2] = {{-half_z, half_z}, {16}};
  solid.filled = [](const vec3&) { return true; };
  return surface_of(solid, with_ridges);
}

triangle_mesh make_coarse_block() {
  // A box of twelve triangles, and one more vertex in the middle of top and bottom: sixteen, symmetric about every
  // axis.
  triangle_mesh mesh;
  for (const double z : {-half_z, half_z})
    for (const double y : {-half_y, half_y})
      for (const double x : {-half_x, half_x}) mesh.positions.emplace_back(x, y, z);
  mesh.positions.emplace_back(0.0, 0.0, -half_z);
  mesh.positions.emplace_back(0.0, 0.0, half_z);
  mesh.triangles = {{0, 2, 8}, {2, 3, 8}, {3, 1, 8}, {1, 0, 8},  // bottom
                    {4, 5, 9}, {5, 7, 9}, {7, 6, 9}, {6, 4, 9},  // top
                    {0, 1, 5}, {0, 5, 4},                        // -y
                    {3, 2, 6}, {3, 6, 7},                        // +y
                    {2, 0, 4}, {2, 4, 6},                        // -x
                    {1, 3, 7}, {1, 7, 5}};                       // +x
  return mesh;
}

}  // namespace asperity::models
