// Moves the coarse surface into the middle of the relief.
#pragma once

#include "asperity/model/triangle_mesh.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// Shifts the vertices along their normals until the relief, seen from the coarse surface, is as much above as below
/// around each of them. Undoes the inset that smoothing and chords across curved surfaces leave, and so keeps
/// displacements and parallax small. Positions stay exact in float32. A step that would fold the mesh is not taken.
/// A cancelled bake leaves the mesh as far as it has come.
/// @param range_m how far along the normal the original is looked for
void fit_to_relief(triangle_mesh& coarse, const triangle_bvh& full, double range_m, unsigned threads = 1,
                   stage_monitor* monitor = nullptr);

}  // namespace asperity::bake
