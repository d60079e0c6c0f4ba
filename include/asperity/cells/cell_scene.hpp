// The cells of all bodies of a scene; finder and depth backend share them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "asperity/cells/make_surface_cells.hpp"
#include "asperity/model/scene.hpp"

namespace asperity {

/// Shared and never changed, like the model it was made of.
using cells_ptr = std::shared_ptr<const surface_cells>;

/// One per body, in the order of the scene.
struct cell_scene {
  cells_ptr probe;
  std::vector<cells_ptr> fixed;

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(fixed) + sizeof(surface_cells) + probe->heap_bytes();
    for (auto c = fixed.begin(); c != fixed.end(); ++c) {
      const bool counted = *c == probe || std::find(fixed.begin(), c, *c) != c;
      if (!counted) bytes += sizeof(surface_cells) + (*c)->heap_bytes();
    }
    return bytes;
  }
};

/// Cuts every model of a scene in cells; a model that appears several times is cut once.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] inline result<cell_scene> make_cell_scene(const scene& bodies, const cell_settings& settings = {}) {
  if (!bodies.probe) return error{error_code::invalid_argument, "the scene has no probe: give it a textured model"};
  const auto cut = [&](const model_ptr& model) -> result<cells_ptr> {
    if (!model) return error{error_code::invalid_argument, "the scene has a fixed body without a model"};
    result<surface_cells> made = make_surface_cells(*model, settings);
    if (!made) return made.error();
    return cells_ptr(std::make_shared<const surface_cells>(std::move(made).value()));
  };
  cell_scene out;
  result<cells_ptr> probe = cut(bodies.probe);
  if (!probe) return probe.error();
  out.probe = std::move(probe).value();
  for (std::size_t b = 0; b < bodies.fixed.size(); ++b) {
    const auto same =
        std::find(bodies.fixed.begin(), bodies.fixed.begin() + static_cast<std::ptrdiff_t>(b), bodies.fixed[b]);
    const auto at = static_cast<std::size_t>(same - bodies.fixed.begin());
    if (bodies.fixed[b] == bodies.probe) {
      out.fixed.push_back(out.probe);
    } else if (at < b) {
      out.fixed.push_back(out.fixed[at]);
    } else {
      result<cells_ptr> made = cut(bodies.fixed[b]);
      if (!made) return made.error();
      out.fixed.push_back(std::move(made).value());
    }
  }
  return out;
}

}  // namespace asperity
