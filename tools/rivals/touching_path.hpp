// The poses of the race: a probe that scrubs over a body, pressed in by up to a millimetre.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "originals.hpp"

namespace asperity::rivals {

/// A pose, and by how much it lies below the first touch of the originals from above.
struct pressed_pose {
  pose T_wa;
  double press_m = 0.0;
};

inline constexpr double most_press_m = 1e-3;

/// Above the middle of the fixed body the probe circles by up to 10 mm and turns and tilts by up to 0.05 rad; at every
/// pose it is put down until the originals touch and pressed on by 0 to 1 mm, up and down five times. Neighbouring
/// poses are a fraction of a millimetre apart, as in a loop. Poses where the bodies pass each other by are left out.
/// @param seed  of the phases
[[nodiscard]] std::vector<pressed_pose> make_touching_path(originals& bodies, const triangle_mesh& probe,
                                                           const triangle_mesh& fixed, std::size_t poses,
                                                           std::uint64_t seed);

}  // namespace asperity::rivals
