#include "asperity/window/paper_renderer.hpp"

#include <utility>

namespace asperity {

result<paper_renderer> make_paper_renderer(scene bodies, const paper_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  // Refuses a missing model too, which the finder takes for granted.
  result<cpu_depth> depth = make_cpu_depth(bodies, settings.depth);
  if (!depth) return depth.error();
  convex_piece_finder finder(bodies, settings.finder);
  return paper_renderer(std::move(bodies), std::move(finder), std::move(depth).value(),
                        gradient_penalty(settings.force), settings.limits);
}

}  // namespace asperity
