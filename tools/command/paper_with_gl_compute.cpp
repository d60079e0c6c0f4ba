// --backend gl-compute: the paper's contacts, their depths in compute shaders.
#include <utility>

#include "asperity/gl/compute_depth.hpp"
#include "paper_on_gpu.hpp"

namespace asperity::command {

result<any_depth> make_gl_compute_depth(const gl::context_ptr& context, const scene& bodies,
                                        const depth_settings& settings, const contact_limits& limits) {
  result<gl::compute_depth> made =
      gl::compute_depth::make(context, bodies, settings, {.contacts = limits.contacts, .triangles = limits.triangles});
  if (!made) return made.error();
  return any_depth(std::move(made).value());
}

result<chosen_renderer> make_paper_with_gl_compute(scene bodies, const render_options& options) {
  return make_paper_on_gpu(std::move(bodies), options, make_gl_compute_depth);
}

}  // namespace asperity::command
