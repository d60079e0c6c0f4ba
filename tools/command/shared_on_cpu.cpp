// --backend cpu with --contacts shared: the library's default renderer.
#include <utility>

#include "asperity/least_motion/default_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_shared_on_cpu(scene bodies, const render_options& options) {
  renderer_settings settings;
  settings.force.period_s = 1.0 / options.contact_rate_hz;
  if (options.contact_stiffness_n_per_m) settings.force.stiffness_n_per_m = *options.contact_stiffness_n_per_m;
  result<renderer> made = make_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
