// What the planes of many poses cost, on a GPU in one submission and on one core one by one. In builds with OpenGL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/gl/context.hpp"
#include "asperity/model/scene.hpp"
#include "progress.hpp"

namespace asperity::command {

/// Times of one number of poses, on the wall.
struct poses_timed {
  std::size_t poses = 0;
  std::vector<double> gpu_s, cpu_s;
  double ratio = 1.0;  ///< of the medians, GPU to CPU
};

/// A batch with one arithmetic.
struct bench_of_planes {
  std::string arithmetic;  ///< double, single
  std::size_t device_bytes = 0;
  double set_up_s = 0.0;
  double too_deep = 0.0;       ///< share of poses with more leaves than there was room for
  double depth_apart_m = 0.0;  ///< the largest difference of a deepest plane's depth
  double force_apart = 0.0;    ///< of the push, 99th percentile, in units of the largest push
  std::vector<poses_timed> sizes;
};

/// Poses about the first touch: up to 1 mm deeper, up to 2 mm aside, turned by up to 0.05 rad.
/// @param poses most at once
/// @return invalid_argument (nothing is touched) | cancelled | unsupported (the device did not answer) | what makers say
[[nodiscard]] result<std::vector<bench_of_planes>> time_planes(const scene& bodies, const gl::context_ptr& context,
                                                               std::size_t poses, std::size_t repeats,
                                                               std::uint64_t seed, progress_line& progress);

}  // namespace asperity::command
