// The renderers that most programs want: the shared formulation, and the paper's.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "asperity/collision/cell_finder.hpp"
#include "asperity/collision/convex_piece_finder.hpp"
#include "asperity/depth/cell_depth.hpp"
#include "asperity/depth/cpu_depth.hpp"
#include "asperity/force/gradient_penalty.hpp"
#include "asperity/force/shared_potential.hpp"
#include "asperity/render/renderer.hpp"
#include "asperity/render/settings.hpp"

namespace asperity {

/// The default: all contacts of two bodies as one potential. The force does not jump, whatever the motion.
using renderer = basic_renderer<cell_finder, cell_depth, shared_potential>;

/// The paper's: contacts clustered from convex pieces, each with a window and a spring of its own.
using paper_renderer = basic_renderer<convex_piece_finder, cpu_depth, gradient_penalty>;

namespace detail {

[[nodiscard]] inline result<void> has_fixed_body(const scene& bodies) {
  if (!bodies.fixed.empty()) return {};
  return error{error_code::invalid_argument, "the scene has no fixed body: give the probe something to touch"};
}

[[nodiscard]] inline result<void> has_cells(const scene& bodies, const cell_scene* cells) {
  bool all = cells != nullptr && bodies.probe && cells->probe && cells->fixed.size() == bodies.fixed.size();
  for (std::size_t b = 0; all && b < bodies.fixed.size(); ++b) all = bodies.fixed[b] && cells->fixed[b];
  if (all) return {};
  return error{error_code::invalid_argument,
               "the cells are not as many as the scene's bodies: cut these bodies, make_cell_scene() does"};
}

/// Softness of the shared maximum for a scene, the automatic one filled in. One for all bodies, whatever the pose.
[[nodiscard]] inline double shared_tau_m(const shared_settings& s, const scene& bodies,
                                         const cell_scene& cells) noexcept {
  if (s.tau_m > 0.0) return s.tau_m;
  double smaller = bodies.probe->box.diagonal(), rougher = cells.probe->relief_m;
  for (std::size_t b = 0; b < bodies.fixed.size(); ++b) {
    smaller = std::min(smaller, bodies.fixed[b]->box.diagonal());
    rougher = std::max(rougher, cells.fixed[b]->relief_m);
  }
  return std::max(0.05 * rougher, 5e-4 * smaller);
}

}  // namespace detail

/// The default renderer for a scene whose models were cut before, by make_cell_scene(); its ticks' memory is taken
/// here. Cutting takes about a second per model: several renderers of the same bodies can share the cells, and their
/// memory.
/// @pre cells are of these bodies, in their order; whether they are as many is checked, whether they are the same is
/// not
/// @return invalid_argument (no probe, no fixed body, cells missing, a setting out of range)
[[nodiscard]] inline result<renderer> make_renderer(scene bodies, std::shared_ptr<const cell_scene> cells,
                                                    const renderer_settings& settings) {
  if (const result<void> ok = detail::has_fixed_body(bodies); !ok) return ok.error();
  if (const result<void> ok = check(settings.shared); !ok) return ok.error();
  if (const result<void> ok = detail::has_cells(bodies, cells.get()); !ok) return ok.error();
  shared_settings shared = settings.shared;
  shared.tau_m = detail::shared_tau_m(shared, bodies, *cells);
  cell_depth depth(cells, bodies, shared);
  return renderer(std::move(bodies), cell_finder(std::move(cells), cell_depth::reach_m(shared), shared.facing_none),
                  std::move(depth), shared_potential(shared, settings.limits.readings()), settings.limits);
}

/// The default renderer for a scene. Cuts its models in cells, about a second each; all memory that its ticks need is
/// taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<renderer> make_renderer(scene bodies, const renderer_settings& settings = {}) {
  if (const result<void> ok = detail::has_fixed_body(bodies); !ok) return ok.error();
  if (const result<void> ok = check(settings.shared); !ok) return ok.error();
  result<cell_scene> cut = make_cell_scene(bodies, settings.cells);  // refuses a missing model too
  if (!cut) return cut.error();
  auto cells = std::make_shared<const cell_scene>(std::move(cut).value());
  return make_renderer(std::move(bodies), std::move(cells), settings);
}

/// The paper's renderer for a scene; all memory that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<paper_renderer> make_paper_renderer(scene bodies, const paper_settings& settings = {}) {
  if (const result<void> ok = detail::has_fixed_body(bodies); !ok) return ok.error();
  // Refuses a missing model too, which the finder takes for granted.
  result<cpu_depth> depth = make_cpu_depth(bodies, settings.depth);
  if (!depth) return depth.error();
  convex_piece_finder finder(bodies, settings.finder);
  return paper_renderer(std::move(bodies), std::move(finder), std::move(depth).value(),
                        gradient_penalty(settings.force), settings.limits);
}

}  // namespace asperity
