#include "render_kinds.hpp"

#include <algorithm>
#include <utility>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "exact/exact_renderer.hpp"

namespace asperity::command {
namespace {

template <class Renderer>
result<any_renderer> erased(result<Renderer> made) {
  if (!made) return made.error();
  return any_renderer(std::move(made).value());
}

}  // namespace

result<any_renderer> make_least_motion_on_cpu(scene bodies, const render_options& options) {
  least_motion_renderer_settings settings;
  settings.force.period_s = 1.0 / options.contact_rate_hz;
  if (options.contact_stiffness_n_per_m) settings.force.stiffness_n_per_m = *options.contact_stiffness_n_per_m;
  return erased(make_renderer(std::move(bodies), settings));
}

result<any_renderer> make_planes_on_cpu(scene bodies, const render_options& options) {
  plane_renderer_settings settings;
  // A loop below 180 Hz meets fast touches a little late: a longer reach would list whole bodies.
  constexpr double usual_hz = 1000.0, most_m = 0.01;
  if (options.contact_rate_hz < usual_hz) {
    settings.reach_m = std::min(most_m, reach_for(1.0 / options.contact_rate_hz));
  }
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

#ifndef ASPERITY_HAS_GL
std::shared_ptr<gpu_use> gpu_use_of(any_renderer&) { return nullptr; }
#endif

}  // namespace asperity::command
