// --backend cpu with --contacts shared: the library's default renderer.
#include <utility>

#include "asperity/render/default_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_shared_on_cpu(scene bodies, const render_options&) {
  result<renderer> made = make_renderer(std::move(bodies));
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
