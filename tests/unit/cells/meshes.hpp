// Untextured models: what cuts a coarse surface in cells looks at its geometry alone.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "asperity/cells/coarse_regions.hpp"
#include "asperity/model/textured_model.hpp"
#include "support/piece_models.hpp"
#include "support/random_hulls.hpp"

namespace asperity::test_support {

/// A mesh with a box around it and a texture that no triangle has a part in: its relief is flat.
inline textured_model bare_model(coarse_mesh mesh) {
  textured_model model;
  model.name = "bare";
  model.mesh = std::move(mesh);
  model.texture.width = model.texture.height = 2;
  model.texture.texels.assign(4, glm::vec3(0.0F));
  model.box = {model.mesh.positions.front(), model.mesh.positions.front()};
  for (const vec3& p : model.mesh.positions) model.box = {glm::min(model.box.low, p), glm::max(model.box.high, p)};
  return model;
}

/// A model with its coarse surface cut.
struct cut_model {
  textured_model model;
  cell_settings settings;
  detail::surface_index index;
  detail::coarse_regions regions;

  explicit cut_model(coarse_mesh mesh, const cell_settings& s = {})
      : model(bare_model(std::move(mesh))),
        settings(resolve(s, model, 0.0)),
        index(model),
        regions(model.mesh, index, settings) {}

  /// Edges of a kind, each once.
  [[nodiscard]] int count(detail::edge_kind kind) const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, detail::edge_kind> edges;
    for (std::size_t t = 0; t < regions.kind.size(); ++t) {
      const auto& v = model.mesh.triangles[t].vertex;
      for (std::size_t k = 0; k < 3; ++k) {
        edges[{std::min(v[k], v[(k + 1) % 3]), std::max(v[k], v[(k + 1) % 3])}] = regions.kind[t][k];
      }
    }
    int n = 0;
    for (const auto& [edge, its_kind] : edges) n += its_kind == kind ? 1 : 0;
    return n;
  }
};

/// L-shaped block: a prism with five convex upright edges and a concave one, at (x, y) = (0, 0).
inline coarse_mesh corner_block(double size, double half_height) {
  // Seen from the middle of the elbow every corner is in sight, as prism_mesh() wants it.
  const vec2 middle(-0.5 * size, -0.5 * size);
  std::vector<vec2> outline{{-size, -size}, {size, -size}, {size, 0.0}, {0.0, 0.0}, {0.0, size}, {-size, size}};
  for (vec2& p : outline) p -= middle;
  coarse_mesh mesh = test::prism_mesh(outline, half_height);
  for (vec3& p : mesh.positions) p += vec3(middle, 0.0);
  return mesh;
}

}  // namespace asperity::test_support
