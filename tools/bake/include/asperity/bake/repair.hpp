// Repair of a mesh before it is baked: everything that is done is counted and told. Component asperity::bake.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

struct repair_settings {
  /// Vertices on open edges are welded within this share of the diagonal, and never across more than 0.4 of the shortest
  /// edge at either; an open edge is split where such a vertex lies on it. At least 1e-6.
  double weld_in_diagonals = 1e-5;
  bool close_holes = true;
  /// A hole in a smooth surface is closed by a patch that goes on smoothly, instead of over its own vertices; a hole whose
  /// surroundings end in an edge is closed flat all the same.
  bool smooth_holes = true;
  bool drop_inner = true;               ///< components within the material of another, which nothing can touch
  bool uncross = true;                  ///< where one component passes through itself
  double largest_made_up_share = 0.25;  ///< of the repaired surface; more is refused
  unsigned threads = 1;                 ///< of the search for crossings; the result does not depend on it
};

/// What a repair can do, in the order in which it is told.
enum class repair_kind : std::uint8_t {
  weld,          ///< vertices merged; change: the farthest that one moved
  degenerate,    ///< triangles without area dropped; change: the longest edge that was collapsed
  t_junction,    ///< vertices set into open edges that they lie on; change: the farthest off the edge
  duplicate,     ///< faces that were there already, dropped; of a doubled inner wall, both
  inner_wall,    ///< triangles of fins and walls that hang on an edge of three, dropped; change: extent of the widest
  split_edge,    ///< edges of more than two triangles, parted into sheets
  split_vertex,  ///< vertices parted where surfaces touched in a point
  turned,        ///< triangles that wound against their neighbours, turned
  loose_piece,   ///< triangles of open pieces too flat or too open to bound a volume, dropped; change: their extent
  hole,          ///< holes closed; change: the longest distance across one
  turned_inside_out,  ///< components turned; `check` turns a whole mesh
  inner_component,    ///< components dropped that lay within another's material; change: extent of the largest
  crossing,           ///< pairs of triangles that crossed and no longer do; change: how far the surface moved
};
inline constexpr std::size_t repair_kinds = 13;

struct repair_action {
  std::size_t count = 0;
  vec3 first{0.0};         ///< where it was done first, m
  double largest_m = 0.0;  ///< largest change to the surface, see repair_kind
};

struct repair_report {
  std::array<repair_action, repair_kinds> actions;
  std::size_t triangles_before = 0, triangles_after = 0;
  std::size_t triangles_added = 0;  ///< made up: of closed holes and resolved crossings
  std::size_t smooth_holes = 0;     ///< of the holes: closed by a patch that goes on smoothly
  double area_added_m2 = 0.0;       ///< of those
  double made_up_share = 0.0;       ///< of those, of the repaired surface

  [[nodiscard]] const repair_action& operator[](repair_kind kind) const noexcept {
    return actions[static_cast<std::size_t>(kind)];
  }
  void add(repair_kind kind, const vec3& at, double change_m, std::size_t count = 1) noexcept;
  [[nodiscard]] std::size_t total() const noexcept;
};

/// The action as it stands in JSON documents, and in words: "vertices welded".
[[nodiscard]] const char* to_string(repair_kind kind) noexcept;
[[nodiscard]] const char* in_words(repair_kind kind, std::size_t count) noexcept;

/// Makes a closed, 2-manifold mesh that bounds a volume of one that nearly is, and keeps its surface where it can. What
/// `check` takes is not changed, except that components that lie within another's material are dropped and that one
/// which passes through itself is mended there. Texture coordinates stay at their corners; they are dropped where a
/// triangle was made up. The same input gives the same bits. What is no mesh at all (no triangles, indices out of
/// range, coordinates that are not finite) is left as it is for `check` to name.
/// @return bad_mesh where more than largest_made_up_share would be made up, or where the mesh cannot be mended; the
///         mesh is then as it was
/// @source Guéziec et al. 2001 (cutting and stitching); Barequet and Sharir 1995 (least-area triangulation of a hole by
///         dynamic programming); Liepa 2003 (angles first, then area; smooth patches)
[[nodiscard]] result<repair_report> repair(triangle_mesh& mesh, const repair_settings& settings = {});

}  // namespace asperity::bake
