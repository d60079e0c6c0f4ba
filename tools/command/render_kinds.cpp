#include "render_kinds.hpp"

#include <algorithm>
#include <utility>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "exact/exact_renderer.hpp"

namespace asperity::command {
namespace {

double smallest_diagonal_m(const scene& bodies) {
  double out_m = bodies.probe->box.diagonal();
  for (const model_ptr& b : bodies.fixed) out_m = std::min(out_m, b->box.diagonal());
  return out_m;
}

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
  // A loop below 180 Hz meets fast touches a little late: a longer reach would list whole bodies. One above 3.6 kHz
  // looks further than it has to, because planes are also asked for where the probe will come to rest.
  constexpr double most_m = 0.01, least_m = 0.0005;
  // What is usual fits small bodies by itself.
  const double usual_m = reach_for(1e-3);
  if (reach_m > usual_m) settings.reach_m = std::min(most_m, reach_m);
  if (reach_m < usual_m) settings.reach_m = std::min(0.1 * smallest_diagonal_m(bodies), std::max(least_m, reach_m));
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

#ifndef ASPERITY_HAS_GL
std::shared_ptr<gpu_use> gpu_use_of(any_renderer&) { return nullptr; }
#endif

}  // namespace asperity::command
