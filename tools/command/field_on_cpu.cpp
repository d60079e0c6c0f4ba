// --contacts field: the renderer for control loops, which holds the probe by support planes.
#include <utility>

#include "asperity/render/field_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_field_on_cpu(scene bodies, const render_options&) {
  result<field_renderer> made = make_field_renderer(std::move(bodies));
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
