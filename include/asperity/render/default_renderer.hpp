// The renderer that most programs want: the paper's finder, the CPU reference depth, the paper's force model.
#pragma once

#include <utility>

#include "asperity/collision/convex_piece_finder.hpp"
#include "asperity/depth/cpu_depth.hpp"
#include "asperity/force/gradient_penalty.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// The default policies. Another choice is basic_renderer with other arguments.
using renderer = basic_renderer<convex_piece_finder, cpu_depth, gradient_penalty>;

/// Settings of the default policies. Each default is explained where its struct is.
struct renderer_settings {
  finder_settings finder{};
  depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

/// A renderer for a scene; all memory that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<renderer> make_renderer(scene bodies, const renderer_settings& settings = {}) {
  if (bodies.fixed.empty()) {
    return error{error_code::invalid_argument, "the scene has no fixed body: give the probe something to touch"};
  }
  // Refuses a missing model too, which the finder takes for granted.
  result<cpu_depth> depth = make_cpu_depth(bodies, settings.depth);
  if (!depth) return depth.error();
  convex_piece_finder finder(bodies, settings.finder);
  return renderer(std::move(bodies), std::move(finder), std::move(depth).value(), gradient_penalty(settings.force),
                  settings.limits);
}

}  // namespace asperity
