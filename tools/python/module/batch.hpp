// Many poses at a time: each thread has a renderer of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "asperity/render/any_renderer.hpp"

namespace asperity::python {

struct batch_outcome {
  std::size_t incomplete = 0;  ///< poses at which a capacity was reached
  status failed = status::ok;  ///< of the first pose that could not be computed
  std::size_t failed_at = 0;   ///< its row
  bool cancelled = false;
};

/// The wrench at each pose, one row of six numbers each. Poses are handed out in blocks to whichever thread is free; a row
/// depends on its pose alone, so the threads' number changes nothing.
/// @param renderers one per thread, alike; the calling thread works too
/// @param keep_going asked on the calling thread between blocks
/// @param version scene_pose::version
/// @pre T_wa.size() * 6 == out.size(); renderers is not empty; they remember nothing, or there is one
[[nodiscard]] batch_outcome step_all(std::span<any_renderer> renderers, std::span<const pose> T_wa,
                                     std::span<const pose> T_wb, std::uint64_t version, std::span<double> out,
                                     const std::function<bool()>& keep_going);

}  // namespace asperity::python
