// Closes gaps along coarse edges that the projection left.
#pragma once

#include <cstddef>

#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/haptic_texture.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// Where the two triangles at a coarse edge look up points more than limit_m apart, moves the texels of both sides
/// until they meet on the original. Both sides are projected along the same directions at the edge, so only places
/// where neighbouring texels find surface far apart are touched: a coarse edge that stands off a rounded one. All other
/// edges keep their texels to the bit.
/// Stops after a fixed number of rounds: a gap may stay where neighbouring points ask the same texels for different
/// things. largest_crack() tells.
/// @param monitor asked on the way; a cancelled bake leaves the texture as far as it has come
/// @return how many edges were worked on
std::size_t stitch(const coarse_mesh& coarse, const triangle_bvh& full, double limit_m, haptic_texture& texture,
                   unsigned threads = 1, stage_monitor* monitor = nullptr);

}  // namespace asperity::bake
