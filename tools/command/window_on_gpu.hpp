// What the backends on a GPU have in common: their device, their fallback, their counts.
#pragma once

#include "asperity/gl/context.hpp"
#include "asperity/render/any_renderer.hpp"
#include "asperity/window/any_depth.hpp"
#include "asperity/window/window_depth_settings.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

using gpu_depth_maker = result<any_depth>(const gl::context_ptr& context, const scene& bodies,
                                          const window_depth_settings& settings, const contact_limits& limits);

gpu_depth_maker make_gl_compute_depth;
gpu_depth_maker make_gl_occlusion_depth;

/// The paper's renderer with a depth backend that `make_depth` makes on the GPU that the options ask for.
/// With --fallback a GPU that cannot be used from the start is a GPU that fails in every tick.
/// @return invalid_argument | bad_mesh | bad_texture | without --fallback also unsupported, limit_exceeded
[[nodiscard]] result<any_renderer> make_window_on_gpu(scene bodies, const render_options& options,
                                                      gpu_depth_maker* make_depth);

}  // namespace asperity::command
