// --backend cpu with --contacts paper.
#include <utility>

#include "asperity/window/paper_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_paper_on_cpu(scene bodies, const render_options& options) {
  paper_settings settings;
  settings.depth = grid_settings(options);
  result<paper_renderer> made = make_paper_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
