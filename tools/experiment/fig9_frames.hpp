// The frames of fig9: a session in which the file scrubs the CAD part, played again with a stopwatch.
#pragma once

#include <string>
#include <vector>

#include "experiment.hpp"

namespace asperity::experiment {

/// The probe's poses at the contact thread's times, and what the paper's collision stage makes of them.
struct scrubbed {
  scene bodies;
  std::vector<pose> T_wa;
  std::vector<double> collision_s;  ///< CPU time
  std::vector<double> contacts;     ///< clusters
  std::vector<double> close_pairs;  ///< pairs of convex pieces closer than the finder's tolerance, ghosts included
};

/// A hand holds the file in the CAD part's large hole, presses it against the wall all the way round, and scrubs along
/// the hole. @return the error of a model, of the renderer's maker or of the trial
[[nodiscard]] result<scrubbed> scrub(workbench& bench);

/// What one renderer takes for the frames: CPU time, or time on the wall where a GPU works.
struct timed_frames {
  variant kind;
  std::vector<double> frame_s;  ///< one per frame; of a backend on a GPU one per 25 frames
};

/// @return what the renderer's maker says
[[nodiscard]] result<timed_frames> time_frames(workbench& bench, const variant& kind, const scrubbed& path);

/// The processor by its own name, as in "Intel(R) Xeon(R) Processor".
[[nodiscard]] std::string machine_name();

}  // namespace asperity::experiment
