// The paper's renderer.
#pragma once

#include "asperity/core/export.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/renderer.hpp"
#include "asperity/window/convex_piece_finder.hpp"
#include "asperity/window/cpu_depth.hpp"
#include "asperity/window/depth_settings.hpp"
#include "asperity/window/gradient_penalty.hpp"

namespace asperity {

/// Settings of make_paper_renderer(). Each default is explained where its struct is.
struct paper_settings {
  finder_settings finder{};
  depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

/// The paper's: contacts clustered from convex pieces, each with a window and a spring of its own.
using paper_renderer = basic_renderer<convex_piece_finder, cpu_depth, gradient_penalty>;

/// The paper's renderer for a scene; all memory that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<paper_renderer> make_paper_renderer(scene bodies,
                                                                      const paper_settings& settings = {});

}  // namespace asperity
