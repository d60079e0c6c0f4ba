// The parts of a soup that enclose nothing a lattice could see: open sheets, and walls thinner than a cell.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// A soup, taken apart.
struct sorted_soup {
  triangle_mesh body;         ///< what has an inside by its winding number
  triangle_mesh plates;       ///< what has none: its pieces, no larger than a cell
  std::vector<vec3> places;   ///< on all of it, about a cell apart
  std::vector<vec3> normals;  ///< of the triangles there
  std::vector<char> plated;   ///< per place: it lies on a plate
  double plate_share = 0.0;   ///< of the area
  bool too_large = false;     ///< more pieces than are looked at
};

/// Most pieces that a soup is cut into.
inline constexpr std::size_t most_soup_pieces = 16'000'000;

/// Takes every connected part out of the body whose inner side has a winding number under 0.7 in the mean. Then, of
/// what is left, marks the surface that has no inside within three quarters of a cell behind it, where it does so for
/// more than two cells in every direction: an edge of a wedge is not a wall.
/// @pre mesh faces outwards, has triangles, all with area
/// @return nothing where cancelled
[[nodiscard]] std::optional<sorted_soup> sort_soup(const triangle_mesh& mesh, double cell_m, unsigned threads,
                                                   stage_monitor& monitor);

}  // namespace asperity::bake
