// First stage of the bake: is this a mesh that can carry a haptic texture?
#pragma once

#include <cstddef>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Sizes outside these are taken for a mix-up of units.
inline constexpr double smallest_diagonal_m = 1e-5;
inline constexpr double largest_diagonal_m = 1e3;
/// Texels are float32: beyond this many diagonals from the origin their step exceeds 0.001 % of the object.
inline constexpr double farthest_in_diagonals = 160.0;
/// A bake takes some 160 bytes of memory a triangle, reading an STL 190: this many take 1.5 GB, and more are refused.
inline constexpr std::size_t most_triangles = 8'000'000;

/// A closed, 2-manifold, outward oriented mesh without unused vertices.
struct checked_mesh {
  triangle_mesh mesh;
  std::size_t components = 0;
  long euler = 0;                    ///< vertices - edges + triangles
  bool flipped = false;              ///< the mesh came inside-out and was turned
  std::size_t turned_triangles = 0;  ///< wound against their neighbours, and turned one by one
};

/// Checks a mesh and turns it the right way out, triangle by triangle where neighbours disagree. Several components are
/// allowed, each closed; one inside another is a cavity and then faces inwards. Triangles keep their order, and texture
/// coordinates stay at their corners; they are not looked at.
/// @param what names the mesh in messages: "the mesh", "the coarse mesh"
/// @return bad_mesh with the fault, its place (triangle and coordinates) and the mend; limit_exceeded
[[nodiscard]] result<checked_mesh> check(triangle_mesh mesh, std::string_view what = "the mesh");

}  // namespace asperity::bake
