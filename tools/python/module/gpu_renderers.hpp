// The paper's contacts with their depths on a GPU, where the package was built with OpenGL.
#pragma once

#include <memory>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/any_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "gpu_use.hpp"

namespace asperity::python {

using command::gpu_use;
struct renderer_wish;

/// The renderer of a wish whose backend is no cpu.
/// @return unsupported (not part of this build; no GPU, without fallback) | limit_exceeded | invalid_argument | bad_mesh |
///         bad_texture
[[nodiscard]] result<any_renderer> make_window_on_gpu(scene bodies, const renderer_wish& wish,
                                                      const window_renderer_settings& settings);

/// What a renderer does with a GPU; null where it uses none.
[[nodiscard]] std::shared_ptr<gpu_use> gpu_use_of(any_renderer& feel);

/// Gives the GPU's context back, so that another thread can step: it belongs to one at a time.
class gpu_visit {
 public:
  explicit gpu_visit(std::shared_ptr<gpu_use> use) : use_(std::move(use)) {}
  gpu_visit(const gpu_visit&) = delete;
  gpu_visit& operator=(const gpu_visit&) = delete;
  ~gpu_visit() {
    if (use_) use_->leave_thread();
  }

 private:
  std::shared_ptr<gpu_use> use_;
};

}  // namespace asperity::python
