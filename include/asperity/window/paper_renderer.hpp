// The paper's renderer.
#pragma once

#include <utility>

#include "asperity/render/renderer.hpp"
#include "asperity/window/convex_piece_finder.hpp"
#include "asperity/window/cpu_depth.hpp"
#include "asperity/window/gradient_penalty.hpp"
#include "asperity/window/paper_settings.hpp"

namespace asperity {

/// The paper's: contacts clustered from convex pieces, each with a window and a spring of its own.
using paper_renderer = basic_renderer<convex_piece_finder, cpu_depth, gradient_penalty>;

/// The paper's renderer for a scene; all memory that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<paper_renderer> make_paper_renderer(scene bodies, const paper_settings& settings = {}) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  // Refuses a missing model too, which the finder takes for granted.
  result<cpu_depth> depth = make_cpu_depth(bodies, settings.depth);
  if (!depth) return depth.error();
  convex_piece_finder finder(bodies, settings.finder);
  return paper_renderer(std::move(bodies), std::move(finder), std::move(depth).value(),
                        gradient_penalty(settings.force), settings.limits);
}

}  // namespace asperity
