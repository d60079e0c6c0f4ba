// What stands behind the opaque handles that several files of the C interface share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "asperity/c/model.h"
#include "asperity/c/renderer.h"
#include "asperity/model/scene.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/render/any_renderer.hpp"
#include "c/entry.hpp"

// NOLINTBEGIN(readability-identifier-naming): names of the C header
struct asperity_model : asperity::c::handle_mark<0x4d617370U> {
  explicit asperity_model(asperity::model_ptr model) : inside(std::move(model)) {}
  asperity::model_ptr inside;
};
// NOLINTEND(readability-identifier-naming)

namespace asperity::c {

inline constexpr std::uint32_t most_fixed = 65'535;
inline constexpr double largest_stiffness = 1e8, largest_friction = 10.0;

/// The scene of these handles. @return invalid_argument
[[nodiscard]] result<scene> scene_of(const asperity_model* probe, const asperity_model* const* fixed,
                                     std::uint32_t count);

/// Deepest contact of a tick, and how many overlap. @rt safe
struct touch_depth {
  double deepest_m = 0.0;
  std::uint32_t overlapping = 0;
};
[[nodiscard]] inline touch_depth depth_of(const tick& found) noexcept {
  touch_depth out;
  for (const penetration& p : found.depths) {
    if (!(p.depth_m > 0.0)) continue;
    out.deepest_m = std::max(out.deepest_m, p.depth_m);
    ++out.overlapping;
  }
  return out;
}

/// Stiffness, dissipation and friction that settings give for every touch; 0: what the materials say.
struct touch_wish {
  double stiffness_n_per_m = 0.0, dissipation_s_per_m = 0.0, static_friction = 0.0, dynamic_friction = 0.0;
};
[[nodiscard]] result<void> check(const touch_wish& wish);
/// Puts them in the place of what the materials say.
void apply(const touch_wish& wish, surface_pairs& to);

}  // namespace asperity::c
