// The renderers that the command offers.
#pragma once

#include <memory>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/any_renderer.hpp"
#include "gpu_use.hpp"
#include "render_choice.hpp"

namespace asperity::command {

using renderer_maker = result<any_renderer>(scene bodies, const render_options& options);

renderer_maker make_least_motion_on_cpu;  ///< --contacts least-motion: the library's default
renderer_maker make_planes_on_cpu;        ///< --contacts planes: support planes, for control loops
renderer_maker make_window_on_cpu;        ///< --contacts window: the paper's
renderer_maker make_window_with_exact;    ///< --backend exact: windows with the maximum itself
// In builds with OpenGL, where ASPERITY_HAS_GL is defined:
renderer_maker make_window_with_gl_compute;    ///< --backend gl-compute
renderer_maker make_window_with_gl_occlusion;  ///< --backend gl-occlusion

/// What a renderer of these does with a GPU; null where it uses none.
[[nodiscard]] std::shared_ptr<gpu_use> gpu_use_of(any_renderer& feel);

}  // namespace asperity::command
