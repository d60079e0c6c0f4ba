// The coarse mesh of a bake: as asked for, or with as many triangles as it takes.
#pragma once

#include "asperity/bake/bake.hpp"
#include "asperity/core/status.hpp"
#include "bake/check.hpp"
#include "bake/simplify.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

struct coarse_choice {
  simplified_mesh made;    ///< in the middle of the original's relief, where it was made by simplifying
  triangle_bvh full_tree;  ///< over the original
  double cage_m = 0.0;     ///< largest distance between the two
};

/// The coarse mesh that the settings give, checked, or one made by simplifying, and how far it is from the original. Where
/// settings.triangles are too few for one that is sound and near enough, more are tried, at least twice as many each time;
/// they are taken where settings.more_triangles allows it, and else named in the refusal.
/// @return bad_mesh | cancelled
[[nodiscard]] result<coarse_choice> choose_coarse(const checked_mesh& full, const bake_settings& settings,
                                                  unsigned threads, stage_monitor& monitor);

}  // namespace asperity::bake
