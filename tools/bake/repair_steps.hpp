// The steps of a repair, one file each. Every step tells what it did, takes n log n time and leaves what it cannot mend.
#pragma once

#include <cstdint>
#include <vector>

#include "asperity/bake/repair.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/geometry.hpp"

namespace asperity::bake {

/// Removes the triangles that are marked, and their texture coordinates.
void drop_triangles(triangle_mesh& mesh, const std::vector<bool>& gone);

/// Splits triangle t at the edge from corner k to the next: vertex v, at share s of the edge, becomes a corner of both
/// halves. The second half is appended.
void split_at_edge(triangle_mesh& mesh, std::uint32_t t, std::uint32_t k, std::uint32_t v, double s);

/// Area of all triangles, m^2.
[[nodiscard]] double area_of(const triangle_mesh& mesh);

/// Signed volume, m^3; of a closed mesh.
[[nodiscard]] double volume_of(const triangle_mesh& mesh);

/// Farthest coordinate from the origin, m: what the rounding of coordinates is relative to.
[[nodiscard]] double reach_of(const triangle_mesh& mesh);

/// welding.cpp
void weld_borders(triangle_mesh& mesh, double tolerance_m, repair_report& report);
void split_t_junctions(triangle_mesh& mesh, double tolerance_m, repair_report& report);

/// degenerate.cpp
void drop_degenerate(triangle_mesh& mesh, repair_report& report);

/// duplicates.cpp
void drop_duplicates(triangle_mesh& mesh, repair_report& report);

/// sheets.cpp: afterwards no edge has more than two triangles
void drop_inner_walls(triangle_mesh& mesh, repair_report& report);
void part_sheets(triangle_mesh& mesh, repair_report& report);

/// holes.cpp. @pre edges with one or two triangles, and consistent winding
void drop_loose_pieces(triangle_mesh& mesh, repair_report& report);
void close_all_holes(triangle_mesh& mesh, const repair_settings& settings, repair_report& report);

/// inner_components.cpp. @pre closed and 2-manifold
void order_components(triangle_mesh& mesh, const repair_settings& settings, repair_report& report);

/// uncross.cpp. @pre closed and 2-manifold; afterwards it still is
void uncross(triangle_mesh& mesh, const repair_settings& settings, repair_report& report);

}  // namespace asperity::bake
