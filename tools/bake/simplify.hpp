// Second stage of the bake: the coarse mesh.
#pragma once

#include <cstddef>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/check.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

struct simplified_mesh {
  triangle_mesh mesh;  ///< positions are exact in float32
  std::string note;    ///< what had to be done differently from what was asked; empty where nothing
};

/// A coarse mesh of about `triangles` triangles with the topology of the full one: the relief is smoothed away, the
/// rest simplified, and the result checked (closed, 2-manifold, same Euler characteristic and number of components, no
/// folded, flipped or degenerate triangle). Where the check fails it tries again, smoothed more or less, or with more
/// triangles. A mesh that has no more triangles than asked for comes back as it is.
/// @pre triangles >= 4
/// @param stuck_at  filled in where it is refused: the fewest triangles at which the topology stopped an attempt, 0 where
///                  none was stopped
/// @return bad_mesh where no attempt gives a sound coarse mesh; cancelled
[[nodiscard]] result<simplified_mesh> simplify(const checked_mesh& full, std::size_t triangles, unsigned threads,
                                               stage_monitor& monitor, std::size_t* stuck_at = nullptr);

/// True where no triangle is degenerate or folded back onto its neighbour. @pre closed 2-manifold
[[nodiscard]] bool is_unfolded(const triangle_mesh& mesh);

/// Rounds all coordinates to float32, which is what a file keeps.
void round_to_float32(triangle_mesh& mesh) noexcept;

}  // namespace asperity::bake
