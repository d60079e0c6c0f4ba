// --contacts field: the renderer for control loops, which holds the probe by support planes.
#include <algorithm>
#include <utility>

#include "asperity/planes/field_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_field_on_cpu(scene bodies, const render_options& options) {
  field_renderer_settings settings;
  // A loop below 180 Hz meets fast touches a little late: a longer reach would list whole bodies.
  constexpr double usual_hz = 1000.0, most_m = 0.01;
  if (options.contact_rate_hz < usual_hz) {
    settings.reach_m = std::min(most_m, reach_for(1.0 / options.contact_rate_hz));
  }
  result<field_renderer> made = make_field_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
