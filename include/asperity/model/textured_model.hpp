// A textured model: coarse mesh, haptic texture, convex pieces and what the bake knows about them.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/bake_report.hpp"
#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/haptic_texture.hpp"
#include "asperity/model/mass_properties.hpp"
#include "asperity/model/material.hpp"

namespace asperity {

struct bounds {
  vec3 low{0.0};
  vec3 high{0.0};
  [[nodiscard]] double diagonal() const noexcept { return std::sqrt(glm::dot(high - low, high - low)); }
};

/// The box about points; at the origin where there is none.
[[nodiscard]] inline bounds bounds_of(std::span<const vec3> points) noexcept {
  if (points.empty()) return {};
  bounds out{points.front(), points.front()};
  for (const vec3& p : points) {
    out.low = glm::min(out.low, p);
    out.high = glm::max(out.high, p);
  }
  return out;
}

struct field_body;

/// The depth field and the samples of a body, see field/field_body.hpp: shared and never changed, like the model that it
/// was made of.
using field_body_ptr = std::shared_ptr<const field_body>;

/// Memory that a field and its samples take, bytes.
[[nodiscard]] ASPERITY_API std::size_t memory_bytes(const field_body& body) noexcept;

/// Everything that a tick needs to know about one body, in its body frame, metres. Immutable once loaded.
struct textured_model {
  std::string name;
  coarse_mesh mesh;
  haptic_texture texture;
  std::vector<convex_piece> pieces;
  mass_properties mass;  ///< of the coarse mesh
  bounds box;            ///< of the coarse mesh
  bake_report report;
  std::optional<material> surface;  ///< what it is like to touch; nothing where nobody said
  /// Where its surface is of other materials; needs `surface`. Felt through support planes; see docs/how-to/materials.md.
  material_map surface_map{};
  /// Made at bake and kept in the file, so that no renderer has to make it; nothing where each makes its own. One that was
  /// not made of this mesh and texture as they are now is not used.
  field_body_ptr field;

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(name, mesh, texture, pieces) + (surface ? surface->heap_bytes() : 0) +
           surface_map.heap_bytes() + (field ? asperity::memory_bytes(*field) : 0);
  }
};

/// How many materials a model has: 1 and those of its map. One that says nothing has one that is not known.
[[nodiscard]] inline std::size_t material_count(const textured_model& model) noexcept {
  return 1 + model.surface_map.others.size();
}
/// Material of this number; nothing where it is not known. @pre number < material_count(model)
[[nodiscard]] inline std::optional<material> material_of(const textured_model& model, std::size_t number) {
  return number == 0 ? model.surface : model.surface_map.others[number - 1];
}
/// Which part of the coarse surface each material has; they add up to 1. Not for a tick. @pre validate(model)
[[nodiscard]] ASPERITY_API std::vector<double> material_shares(const textured_model& model);
/// Says what of a model's materials and their map is wrong.
/// @return invalid_argument (a number out of range) | bad_texture (the map fits no list, or not the haptic texture)
[[nodiscard]] ASPERITY_API result<void> check_materials(const textured_model& model);

/// Memory that a model takes, bytes: itself and all that it holds. See heap_bytes() for what is counted.
[[nodiscard]] inline std::size_t memory_bytes(const textured_model& model) noexcept {
  return sizeof model + model.heap_bytes();
}

/// A model is shared by finder, depth backend and force model, and never changes.
using model_ptr = std::shared_ptr<const textured_model>;

}  // namespace asperity
