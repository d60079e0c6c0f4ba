#include "asperity/window/window_renderer.hpp"

#include <utility>

namespace asperity {

result<window_renderer> make_window_renderer(scene bodies, const window_renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  // Refuses a missing model too, which the finder takes for granted.
  result<cpu_depth> depth = make_cpu_depth(bodies, settings.depth);
  if (!depth) return depth.error();
  convex_piece_finder finder(bodies, settings.finder);
  return window_renderer(std::move(bodies), std::move(finder), std::move(depth).value(),
                         gradient_penalty(settings.force), settings.limits);
}

}  // namespace asperity
