// A closed surface between the inside and the outside points of a body-centred lattice, of which only what lies at the
// surface is looked at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "asperity/core/math.hpp"
#include "bake/halfedges.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Number of a lattice node: its coordinates, all even or all odd, below 2^20 each.
using lattice_key = std::uint64_t;
struct lattice_point {
  std::int32_t x = 0, y = 0, z = 0;
};
[[nodiscard]] constexpr lattice_key key_of(const lattice_point& p) noexcept {
  return static_cast<lattice_key>(p.z) << 42U | static_cast<lattice_key>(p.y) << 21U | static_cast<lattice_key>(p.x);
}
[[nodiscard]] constexpr lattice_point point_of(lattice_key key) noexcept {
  constexpr lattice_key mask = (lattice_key{1} << 21U) - 1;
  return {static_cast<std::int32_t>(key & mask), static_cast<std::int32_t>(key >> 21U & mask),
          static_cast<std::int32_t>(key >> 42U)};
}

/// Most blocks of 1024 nodes that are looked at, and most vertices of the surface.
inline constexpr std::size_t most_lattice_blocks = 60'000;
inline constexpr std::size_t most_lattice_vertices = 4'000'000;

/// Two cubic grids of edge cell_m, one in the middle of the other's cells. Its tetrahedra are all alike: an edge of one
/// grid and an edge of the other that cross at right angles.
struct lattice_frame {
  vec3 origin{0.0};
  double cell_m = 0.0;
  std::size_t most_vertices = most_lattice_vertices;
  std::array<std::int32_t, 3> most{};  ///< nodes beyond these, or below 2, are outside without being asked

  [[nodiscard]] vec3 position(const lattice_point& p) const noexcept {
    return origin + 0.5 * cell_m * vec3(p.x, p.y, p.z);
  }
  /// The 16 nodes among which are the corners of the tetrahedron that holds p. @pre p within the frame
  [[nodiscard]] std::array<lattice_key, 16> around(const vec3& p) const noexcept;
};

/// What the surface is the boundary of.
struct lattice_body {
  /// At least 0 inside, below outside. Called from several threads at once.
  std::function<float(const vec3& p)> value;
  /// Where along the segment from an inside to an outside point the surface is, 0 to 1.
  std::function<double(const vec3& inside, const vec3& outside, float value_inside, float value_outside)> cut;
};

/// No vertex is nearer to a lattice node than this share of the edge that it lies on: no triangle without area.
inline constexpr double least_cut = 0.15;

struct lattice_surface {
  std::vector<vec3> positions;
  std::vector<index_triangle> triangles;
  bool too_large = false;  ///< a limit was met: there is nothing else here
};

/// The surface that passes the nodes around the seeds, and all that is connected with it. Closed and 2-manifold, and no
/// two triangles cross, whatever the body: each lies within one tetrahedron, and every tetrahedron around an edge with
/// a vertex is looked at. Does not depend on the number of threads.
/// @return nothing where it was cancelled
[[nodiscard]] std::optional<lattice_surface> surface_on_lattice(const lattice_frame& frame,
                                                                std::vector<lattice_key> seeds,
                                                                const lattice_body& body, unsigned threads,
                                                                stage_monitor& monitor);

}  // namespace asperity::bake
