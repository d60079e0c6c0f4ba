// A closed surface around any triangles: what a bake can take where a repair cannot. Component asperity::bake.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/bake_report.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Cells along the diagonal where none is asked for, and the most that may be asked for.
inline constexpr double default_wrap_cells = 200.0;
inline constexpr double most_wrap_cells = 2000.0;
/// A plate is at least so many cells thick: a thinner one would have holes.
inline constexpr double least_plate_cells = 2.0;
inline constexpr double default_plate_cells = 2.5;

struct wrap_settings {
  /// Edge of a cell, m: what is finer is lost. Nothing: the diagonal / default_wrap_cells, or finer where thickness_m
  /// needs it, or coarser where that would make more than a million triangles.
  std::optional<double> cell_m{};
  /// Of the plates that stand for open sheets and for walls thinner than a cell, m. Nothing: default_plate_cells.
  std::optional<double> thickness_m{};
  unsigned threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
  /// Called with every stage and its share done, 0 to 1; returning false cancels.
  std::function<bool(std::string_view stage, double done)> progress{};
};

/// What a wrap did. Lengths in metres, shares by area, 0 to 1.
struct wrap_report {
  double cell_m = 0.0;
  double thickness_m = 0.0;
  std::size_t triangles_in = 0;
  std::size_t triangles = 0;
  std::size_t components = 0;         ///< separate surfaces of the result; none lies within another
  std::size_t dropped_triangles = 0;  ///< of the original: without area, or given twice
  std::size_t turned_triangles = 0;   ///< of the original: faced away from where they can be seen from
  double plate_share = 0.0;           ///< of the original's area that became plates
  std::size_t cavities_filled = 0;    ///< closed surfaces within the result that nothing can touch
  std::size_t specks_dropped = 0;     ///< pieces of the result smaller than two cells
  length_spread to_original;          ///< from the result to the original
  length_spread to_wrap;              ///< from the original to the result
  double far_m = 0.0;                 ///< a cell; 0.6 of the thickness where there are plates and that is more
  double made_up_share = 0.0;         ///< of the result's area: farther than far_m from the original
  double lost_share = 0.0;            ///< of the original's area: farther than far_m from the result
};

/// A closed 2-manifold surface, outward oriented, that check() takes, of any triangles: holes, flipped, doubled, crossing
/// and loose ones. Inside is where their winding number is at least one half, and what is within half the thickness of
/// a sheet. On the original where it is near; a crease is cut off by less than a cell, and what is within is left out.
/// The same bits with any number of threads. Texture coordinates are dropped.
/// Takes 110 bytes of memory a triangle and some 800 a triangle of the result.
/// @param report filled in where it succeeds
/// @return bad_mesh (an index out of range, a coordinate that is not finite, no area, a size that is none of an object)
///         | invalid_argument (the settings) | limit_exceeded (a cell too small for the memory) | cancelled
/// @source Jacobson, Kavan and Sorkine-Hornung 2013 (generalised winding number); Barill et al. 2018 (its expansion over
///         a tree); Doi and Koide 1991 (marching tetrahedra), on a body-centred lattice
[[nodiscard]] result<triangle_mesh> wrap(const triangle_mesh& mesh, const wrap_settings& settings, wrap_report& report);

/// Whether wrap() would take the mesh, so that a refusal may offer it.
[[nodiscard]] bool can_wrap(const triangle_mesh& mesh) noexcept;

}  // namespace asperity::bake
