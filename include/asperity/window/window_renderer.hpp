// The renderer of contact windows, which is the paper's.
#pragma once

#include <utility>

#include "asperity/core/export.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/renderer.hpp"
#include "asperity/window/convex_piece_finder.hpp"
#include "asperity/window/cpu_depth.hpp"
#include "asperity/window/gradient_penalty.hpp"
#include "asperity/window/window_depth_settings.hpp"

namespace asperity {

/// Settings of make_window_renderer(). Each default is explained where its struct is.
struct window_renderer_settings {
  window_finder_settings finder{};
  window_depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

/// The paper's formulation: contacts clustered from convex pieces, each with a window and a spring of its own.
using window_renderer = basic_renderer<convex_piece_finder, cpu_depth, gradient_penalty>;

/// The window renderer for a scene; all memory that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<window_renderer> make_window_renderer(scene bodies,
                                                                        const window_renderer_settings& settings = {});

/// The same as make_window_renderer(), named after the paper.
[[nodiscard]] inline result<window_renderer> make_paper_renderer(scene bodies,
                                                                 const window_renderer_settings& settings = {}) {
  return make_window_renderer(std::move(bodies), settings);
}

}  // namespace asperity
