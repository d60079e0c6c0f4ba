// A body as the shared formulation sees it: relief maps to be measured against, and samples to measure with.
//
// Everything here is fixed to the body. Directions, sample points and fades do not depend on what the collision finder
// reports, which is why the force does not jump when that changes. docs/explanation/many-contacts.md tells the idea.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "asperity/cells/cell_settings.hpp"
#include "asperity/collision/aabb_tree.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

/// A node of a relief map.
struct relief_node {
  float height_m = 0.0F;     ///< fine surface over the cell's plane
  float clearance_m = 0.0F;  ///< soft distance to where the cell ends; negative beyond
};

/// A coarse region of nearly one direction, with its fine surface as heights over a plane. Body frame.
///
/// The map reaches beyond the region: over smooth edges as far as the apron, so that a curved surface cut in cells has
/// no seams, and beyond concave edges, where the foot of a deep sample may lie inside the neighbouring wall. At convex
/// edges it ends, and the samples on the edge itself take over.
struct surface_cell {
  vec3 origin_b{0.0};
  vec3 u_b{1.0, 0.0, 0.0}, v_b{0.0, 1.0, 0.0}, n_b{0.0, 0.0, 1.0};  ///< orthonormal; n outwards
  vec2 low{0.0};                                                    ///< cell coordinates of node (0, 0), metres
  double pitch_m = 0.0;                                             ///< distance between nodes
  std::uint32_t columns = 0, rows = 0;
  std::size_t first = 0;                   ///< node (0, 0) in surface_cells::nodes; row-major
  double lowest_m = 0.0, highest_m = 0.0;  ///< heights where the cell has clearance; highest < lowest: nowhere
  double depth_limit_m = 0.0;              ///< samples deeper than this have faded to nothing
  double area_m2 = 0.0;                    ///< of the coarse region
  std::uint32_t triangles = 0;             ///< coarse triangles in the region

  /// Body point to cell coordinates: x, y across, z the height over the plane.
  [[nodiscard]] vec3 to_cell(const vec3& p_b) const noexcept {
    const vec3 d = p_b - origin_b;
    return {glm::dot(u_b, d), glm::dot(v_b, d), glm::dot(n_b, d)};
  }
};

/// A point of the fine surface and the area it stands for.
struct surface_sample {
  glm::vec3 position_b{0.0F};
  float area_m2 = 0.0F;
};

/// Neighbouring samples that share one origin, with a ball around them.
struct sample_tile {
  std::uint32_t first = 0, count = 0;  ///< in surface_cells::samples
  std::uint32_t origin = 0;            ///< in surface_cells::origins
  vec3 centre_b{0.0};
  double radius_m = 0.0;
};

/// Where samples come from: a cell, a sharp edge or a vertex of one.
struct sample_origin {
  vec3 normal_b{0.0};  ///< of the cell; zero for an edge or a vertex
  /// For an edge or a vertex: the directions that leave it along the surface, in surface_cells::outgoing. It can be the
  /// deepest point along a direction only where all of these lead back.
  std::uint32_t first_outgoing = 0, outgoing = 0;
};

/// A straight sharp convex edge, merged from collinear coarse edges, for contact of edge with edge.
struct sharp_edge {
  vec3 from_b{0.0}, along_b{1.0, 0.0, 0.0};  ///< along: unit
  double length_m = 0.0;
  vec3 face_b[2]{};                            ///< unit, in the two faces, away from the edge
  std::uint32_t first_relief = 0, relief = 0;  ///< nodes in surface_cells::edge_relief, evenly from end to end; 0: none
  double extension_m[2]{};  ///< at `from` and at the other end: how far it may reach into the edge that goes on there
};

/// All of one body. Immutable once made.
struct surface_cells {
  cell_settings settings;  ///< resolved
  double relief_m = 0.0;   ///< peak to valley of the sine with the texture's mean square height
  std::vector<surface_cell> cells;
  std::vector<relief_node> nodes;
  std::vector<surface_sample> samples;
  std::vector<sample_tile> tiles;
  std::vector<sample_origin> origins;
  std::vector<vec3> outgoing;
  std::vector<sharp_edge> edges;
  std::vector<glm::vec3> edge_relief;  ///< from a point of a sharp edge to the fine surface there, metres
  double largest_edge_relief_m = 0.0;
  aabb_tree tile_tree;
  aabb_tree edge_tree;

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(cells, nodes, samples, tiles, origins, outgoing, edges, edge_relief, tile_tree,
                                edge_tree);
  }
};

}  // namespace asperity
