// Which bodies touch, and where they are in this tick.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// The probe A, which the user moves, and the bodies B that it may touch. Fixed for the life of a renderer, unless the
/// renderer takes a placed_scene.
struct scene {
  model_ptr probe;
  std::vector<model_ptr> fixed;
};

/// Names a body of a scene that changes. A slot is used again after its body was removed; the generation tells the two
/// bodies apart.
struct body_handle {
  std::uint32_t slot = 0;        ///< index in scene::fixed, as in support_plane::body and body_motion::body
  std::uint32_t generation = 0;  ///< of the body in that slot; 0 names no body

  friend bool operator==(const body_handle&, const body_handle&) = default;
};

/// One version of a scene that changes: which body is in which slot, and where. It does not change once it is shared.
struct placed_scene {
  std::uint64_t version = 0;              ///< counts from 1; 0 is a scene that never changes
  scene bodies;                           ///< fixed: one per slot, null where the slot is free
  std::vector<pose> T_wb;                 ///< one per slot
  std::vector<std::uint32_t> generation;  ///< one per slot: body_handle::generation of its body, 0 where it is free
  /// One per slot: the version that put this body there, by adding, exchanging or placing it, or that removed the last.
  std::vector<std::uint64_t> since;
  surface_pairs surfaces;  ///< one per slot: what the probe and the body make of a touch

  [[nodiscard]] bool has(const body_handle& body) const noexcept {
    return body.generation != 0 && body.slot < generation.size() && generation[body.slot] == body.generation;
  }
};

/// Checks that a scene has a body for the probe to touch. @return invalid_argument
[[nodiscard]] inline result<void> check_has_fixed_body(const scene& bodies) {
  if (!bodies.fixed.empty()) return {};
  return error{error_code::invalid_argument, "the scene has no fixed body: give the probe something to touch"};
}

/// Adds the pairs of two bodies with maps to those that are known. @param body of the fixed one
inline void add_mapped_pairs(const textured_model& probe, std::uint32_t body, const textured_model& fixed,
                             surface_pairs& to) {
  for (std::size_t a = 0; a < material_count(probe); ++a) {
    for (std::size_t b = 0; b < material_count(fixed); ++b) {
      const std::optional<surface_pair> pair = combined(material_of(probe, a), material_of(fixed, b));
      if (a + b == 0 || !pair) continue;
      to.mapped.push_back({body, static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), *pair});
    }
  }
}

/// What the probe's surface and that of each fixed body make of a touch, all over where they have maps of materials.
/// @pre every model has been checked
[[nodiscard]] inline surface_pairs surfaces_of(const scene& bodies) {
  surface_pairs out;
  for (const model_ptr& b : bodies.fixed) {
    add_mapped_pairs(*bodies.probe, static_cast<std::uint32_t>(out.size()), *b, out);
    out.push_back(combined(bodies.probe->surface, b->surface));
  }
  return out;
}

/// Memory that a scene's models take, bytes; a model that appears several times counts once.
[[nodiscard]] inline std::size_t memory_bytes(const scene& bodies) noexcept {
  std::size_t bytes = sizeof bodies + heap_bytes(bodies.fixed) + (bodies.probe ? memory_bytes(*bodies.probe) : 0);
  for (auto m = bodies.fixed.begin(); m != bodies.fixed.end(); ++m) {
    const bool counted = *m == bodies.probe || std::find(bodies.fixed.begin(), m, *m) != m;
    if (*m && !counted) bytes += memory_bytes(**m);
  }
  return bytes;
}

/// Poses of a scene's bodies in one tick. @pre T_wb.size() == scene.fixed.size() and outlives the call
struct scene_pose {
  pose T_wa;
  std::span<const pose> T_wb;
  /// Gaps are wanted up to this, m; a renderer may tell larger ones, and tells none beyond its own reach.
  double gaps_m = std::numeric_limits<double>::infinity();
  /// Not 0: every body is where the placed_scene of this version has it, but for those in `moved`, which are in it from
  /// their first motion on. It spares a renderer the look at each of them.
  std::uint64_t version = 0;
  std::span<const std::uint32_t> moved{};
};

/// Centre of mass of the probe in the world: the point c_A that torques and gradients are about.
[[nodiscard]] inline vec3 centre_of_mass_w(const scene& s, const pose& T_wa) noexcept {
  return T_wa * s.probe->mass.centre_of_mass;
}

}  // namespace asperity
