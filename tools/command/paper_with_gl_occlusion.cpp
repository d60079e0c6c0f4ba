// --backend gl-occlusion: the paper's contacts, their depths by the paper's own algorithm.
#include <utility>

#include "asperity/gl/occlusion_depth.hpp"
#include "paper_on_gpu.hpp"

namespace asperity::command {

result<any_depth> make_gl_occlusion_depth(const gl::context_ptr& context, const scene& bodies,
                                          const depth_settings& settings, const contact_limits& limits) {
  result<gl::occlusion_depth> made = gl::occlusion_depth::make(
      context, bodies, settings, {.contacts = limits.contacts, .triangles = limits.triangles});
  if (!made) return made.error();
  return any_depth(std::move(made).value());
}

result<chosen_renderer> make_paper_with_gl_occlusion(scene bodies, const render_options& options) {
  return make_paper_on_gpu(std::move(bodies), options, make_gl_occlusion_depth);
}

}  // namespace asperity::command
