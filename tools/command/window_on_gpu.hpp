// The paper's renderer with its depths on a GPU: the device, the fallback, the counts.
#pragma once

#include <memory>
#include <string>

#include "asperity/gl/context.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/any_renderer.hpp"
#include "asperity/window/any_depth.hpp"
#include "asperity/window/window_renderer.hpp"
#include "gpu_use.hpp"

namespace asperity::command {

using gpu_depth_maker = result<any_depth>(const gl::context_ptr& context, const scene& bodies,
                                          const window_depth_settings& settings, const contact_limits& limits);

gpu_depth_maker make_gl_compute_depth;
gpu_depth_maker make_gl_occlusion_depth;

/// What computes the depths, on which GPU, and what happens where it cannot be used.
struct gpu_wish {
  gpu_depth_maker* make_depth = make_gl_compute_depth;
  std::string device;     ///< index of a GPU or part of its name; empty: the first that works
  bool fallback = false;  ///< the CPU answers where the GPU does not, from the start too
  std::string instead;    ///< what an error offers where the GPU cannot be used
};

/// @return invalid_argument | bad_mesh | bad_texture | without fallback also unsupported, limit_exceeded
[[nodiscard]] result<any_renderer> make_window_on_gpu(scene bodies, const gpu_wish& wish,
                                                      const window_renderer_settings& settings);

/// What such a renderer does with its GPU; null for every other one.
[[nodiscard]] std::shared_ptr<gpu_use> gpu_use_of(any_renderer& feel);

}  // namespace asperity::command
