// A renderer as Python holds it: one for single steps, and one more for each thread of a batch.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "asperity/render/any_renderer.hpp"
#include "renderer_source.hpp"

namespace asperity::python {

struct renderer_handle {
  std::shared_ptr<const renderer_source> source;
  std::vector<pose> T_wb;
  scene_seen seen;                 ///< of a scene that changes; such a renderer has no more than the first of `feel`
  std::vector<any_renderer> feel;  ///< the first for single steps; the others are made when a batch first asks for them
  std::uint64_t incomplete = 0;    ///< steps at which a capacity was reached
  std::mutex busy;                 ///< several threads of Python may call; the GIL is not held meanwhile
};

}  // namespace asperity::python
