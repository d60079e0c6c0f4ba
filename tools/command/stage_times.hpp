// What contacts and ticks cost, stage by stage, along a path over two bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/depth_backend.hpp"
#include "progress.hpp"

namespace asperity::command {

/// A path of poses, the same for the same seed.
struct scrubbing {
  std::size_t poses = 2000;
  std::uint64_t seed = 1;
  unsigned threads = 2;  ///< of ticks that are shared
};

/// How many bodies out of reach a tick is also timed with.
inline constexpr std::size_t far_bodies = 100;

/// CPU times along a path, one entry per pose; contact times are divided by the contacts of the pose.
struct stage_times {
  std::vector<double> query_s;
  std::vector<double> soft_contact_s, central_contact_s;
  std::vector<double> least_motion_tick_s, soft_tick_s, central_tick_s;
  std::vector<double> planes_tick_s;   ///< of the plane renderer, with the probe at the surface, as a loop keeps it
  std::vector<double> every_sample_s;  ///< what reading all samples that such a tick finds near would take
  /// The same ticks in a scene with far_bodies more bodies that are all out of reach.
  std::vector<double> planes_far_tick_s, soft_far_tick_s;
  /// Time on the wall of ticks that follow the path, of one thread and of several that share them; the latter empty where
  /// this machine has fewer processors.
  std::vector<double> follow_s, follow_shared_s;
  double sum_of_samples = 0.0;  ///< of that reading, so that it is made
  /// What a device tick spends on the probe: eight substeps against the planes of such a tick, under the usual coupling,
  /// without friction and with a coefficient of 0.4.
  std::vector<double> probe_s, rubbing_probe_s;
  std::vector<double> planes_held;  ///< how many planes that contact had
  std::vector<depth_work> planes_work;
  std::vector<double> contacts;
};

/// Times all formulations on the same path, which scrubs over the place where the probe first touches.
/// @return invalid_argument (nothing is touched) | cancelled | what make_renderer() says
[[nodiscard]] result<stage_times> time_stages(const scene& bodies, const scrubbing& motion, progress_line& progress);

}  // namespace asperity::command
