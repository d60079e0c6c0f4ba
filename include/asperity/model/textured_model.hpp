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
  /// Made at bake and kept in the file, so that no renderer has to make it; nothing where each makes its own. One that was
  /// not made of this mesh and texture as they are now is not used.
  field_body_ptr field;

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(name, mesh, texture, pieces) + (surface ? surface->heap_bytes() : 0) +
           (field ? asperity::memory_bytes(*field) : 0);
  }
};

/// Memory that a model takes, bytes: itself and all that it holds. See heap_bytes() for what is counted.
[[nodiscard]] inline std::size_t memory_bytes(const textured_model& model) noexcept {
  return sizeof model + model.heap_bytes();
}

/// A model is shared by finder, depth backend and force model, and never changes.
using model_ptr = std::shared_ptr<const textured_model>;

}  // namespace asperity
