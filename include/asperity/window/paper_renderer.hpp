// The paper's renderer.
#pragma once

#include "asperity/core/export.hpp"
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
[[nodiscard]] ASPERITY_API result<paper_renderer> make_paper_renderer(scene bodies,
                                                                      const paper_settings& settings = {});

}  // namespace asperity
