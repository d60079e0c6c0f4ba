// The paper's renderer with the exact maximum in place of a grid of samples.
#pragma once

#include <utility>

#include "asperity/render/renderer.hpp"
#include "asperity/window/convex_piece_finder.hpp"
#include "asperity/window/gradient_penalty.hpp"
#include "exact/exact_depth.hpp"

namespace asperity {

/// As window_renderer, with exact_depth. For tests and work at a desk: a step takes as long as its search. See
/// exact_depth.
using exact_renderer = basic_renderer<convex_piece_finder, exact_depth, gradient_penalty>;

/// Settings of its policies.
struct exact_renderer_settings {
  window_finder_settings finder{};
  exact_depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

/// A renderer with the exact maximum for a scene.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<exact_renderer> make_exact_renderer(scene bodies,
                                                                const exact_renderer_settings& settings = {}) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<exact_depth> depth = make_exact_depth(bodies, settings.depth);  // refuses a missing model too
  if (!depth) return depth.error();
  convex_piece_finder finder(bodies, settings.finder);
  return exact_renderer(std::move(bodies), std::move(finder), std::move(depth).value(),
                        gradient_penalty(settings.force), settings.limits);
}

}  // namespace asperity
