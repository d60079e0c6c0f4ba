// --backend cpu with --contacts paper.
#include <utility>

#include "asperity/render/default_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_paper_on_cpu(scene bodies, const render_options& options) {
  paper_settings settings;
  settings.depth.gradient =
      gradient_name(options) == "central" ? gradient_scheme::central_difference : gradient_scheme::soft_max;
  if (options.grid) settings.depth.grid = *options.grid;
  result<paper_renderer> made = make_paper_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
