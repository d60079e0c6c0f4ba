// A pose from which a probe comes down onto a body.
#pragma once

#include <functional>
#include <span>

#include "asperity/render/renderer.hpp"

namespace asperity::command {

/// One tick of some renderer.
using step_function = std::function<status(const scene_pose&, tick&)>;

/// Where the probe, held as `orientation` says, first touches a fixed body when it comes straight down along -z, its
/// box centred over the first body's. Found by lowering it until a depth is positive and halving the last step.
/// @return the touching pose, or invalid_argument where nothing was met on the way down
[[nodiscard]] result<pose> find_touch(const scene& bodies, const step_function& feel, const quat& orientation,
                                      std::span<const pose> T_wb);

}  // namespace asperity::command
