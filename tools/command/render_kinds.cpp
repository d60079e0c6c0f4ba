#include "render_kinds.hpp"

#include <algorithm>
#include <utility>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "exact/exact_renderer.hpp"
#include "plane_reach.hpp"
#ifdef ASPERITY_HAS_GL
#include "window_on_gpu.hpp"
#endif

namespace asperity::command {
namespace {

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

template <class Renderer>
result<any_renderer> erased(result<Renderer> made) {
  if (!made) return made.error();
  return any_renderer(std::move(made).value());
}

}  // namespace

result<any_renderer> make_least_motion_on_cpu(scene bodies, const render_options& options) {
  least_motion_renderer_settings settings;
  settings.force.period_s = seconds(options.periods.renewal_ns());
  if (options.contact_stiffness_n_per_m) settings.force.stiffness_n_per_m = *options.contact_stiffness_n_per_m;
  return erased(make_renderer(std::move(bodies), settings));
}

result<any_renderer> make_planes_on_cpu(scene bodies, const render_options& options) {
  plane_renderer_settings settings;
  const double reach_m = std::max(1.0, options.motion_scale) *
                         reach_for(seconds(options.periods.contact_ns), seconds(options.periods.device_ns));
  settings.reach_m = plane_reach_m(bodies, reach_m);
  settings.threads = options.threads;
  settings.set_up_helper = options.set_up_helper;
  return erased(make_plane_renderer(std::move(bodies), settings));
}

result<any_renderer> make_window_on_cpu(scene bodies, const render_options& options) {
  window_renderer_settings settings;
  settings.depth = grid_settings(options);
  return erased(make_window_renderer(std::move(bodies), settings));
}

result<any_renderer> make_window_with_exact(scene bodies, const render_options&) {
  return erased(make_exact_renderer(std::move(bodies)));
}

#ifdef ASPERITY_HAS_GL
namespace {

result<any_renderer> make_window_with(gpu_depth_maker* make_depth, scene bodies, const render_options& options) {
  return make_window_on_gpu(std::move(bodies),
                            {.make_depth = make_depth,
                             .device = options.gpu.value_or(""),
                             .fallback = options.fallback,
                             .instead = "; or use --backend cpu, or --fallback"},
                            {.depth = grid_settings(options)});
}

}  // namespace

result<any_renderer> make_window_with_gl_compute(scene bodies, const render_options& options) {
  return make_window_with(make_gl_compute_depth, std::move(bodies), options);
}

result<any_renderer> make_window_with_gl_occlusion(scene bodies, const render_options& options) {
  return make_window_with(make_gl_occlusion_depth, std::move(bodies), options);
}
#else
std::shared_ptr<gpu_use> gpu_use_of(any_renderer&) { return nullptr; }
#endif

}  // namespace asperity::command
