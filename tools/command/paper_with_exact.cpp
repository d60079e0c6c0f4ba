// --backend exact: the paper's contacts with the maximum itself.
#include <utility>

#include "exact/exact_renderer.hpp"
#include "render_kinds.hpp"

namespace asperity::command {

result<chosen_renderer> make_paper_with_exact(scene bodies, const render_options&) {
  result<exact_renderer> made = make_exact_renderer(std::move(bodies));
  if (!made) return made.error();
  return chosen_renderer(std::move(made).value());
}

}  // namespace asperity::command
