// Solids built of lattice cells: a closed surface of quads whose count is known before it is made.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::models {

/// One axis of a lattice: n + 1 increasing breakpoints in metres, and the number of cells in each of the n slabs.
struct lattice_axis {
  std::vector<double> breaks_m;
  std::vector<std::uint32_t> cells;
};

/// A solid on a lattice of slabs. `filled` is asked once per slab box, with its centre. Filled boxes must meet in whole
/// faces, never in an edge or a corner alone: the surface would not be a manifold there.
struct lattice_solid {
  std::array<lattice_axis, 3> axes;
  std::function<bool(const vec3& centre_m)> filled;
};

/// Surface of the solid, bent by `map`: two triangles for every lattice face between filled and empty, outward oriented
/// where the map keeps orientation. `map` sees every vertex once; coordinates on breakpoints are exact.
/// The map must be one-to-one on the surface; then nothing intersects.
[[nodiscard]] triangle_mesh surface_of(const lattice_solid& solid, const std::function<vec3(const vec3&)>& map);

/// Bends the square of half side `inner` about the origin into a disc of that radius, and leaves everything outside
/// the square of half side `outer` alone. One-to-one: it only moves points along rays from the origin.
/// @pre 0 < inner < outer
[[nodiscard]] vec2 square_to_disc(const vec2& p, double inner, double outer) noexcept;

}  // namespace asperity::models
