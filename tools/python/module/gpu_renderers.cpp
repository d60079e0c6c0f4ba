#include "gpu_renderers.hpp"

#include <utility>

#include "renderer_source.hpp"
#ifdef ASPERITY_HAS_GL
#include "window_on_gpu.hpp"
#endif

namespace asperity::python {

#ifdef ASPERITY_HAS_GL

result<any_renderer> make_window_on_gpu(scene bodies, const renderer_wish& wish,
                                        const window_renderer_settings& settings) {
  return command::make_window_on_gpu(
      std::move(bodies),
      {.make_depth = wish.backend == "gl-compute" ? command::make_gl_compute_depth : command::make_gl_occlusion_depth,
       .device = wish.gpu,
       .fallback = wish.fallback,
       .instead = "; or use backend='cpu', or fallback=True"},
      settings);
}

std::shared_ptr<gpu_use> gpu_use_of(any_renderer& feel) { return command::gpu_use_of(feel); }

#else

result<any_renderer> make_window_on_gpu(scene, const renderer_wish& wish, const window_renderer_settings&) {
  return error{error_code::unsupported,
               "the depth backend " + wish.backend +
                   " is not part of this build: use backend='cpu', or configure with "
                   "-DASPERITY_BUILD_GL=ON and OpenGL's headers (Debian: libegl-dev, libgl-dev)"};
}

std::shared_ptr<gpu_use> gpu_use_of(any_renderer&) { return nullptr; }

#endif

}  // namespace asperity::python
