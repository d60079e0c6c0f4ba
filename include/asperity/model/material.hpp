// What a body's surface is like to touch, and what two surfaces make of a touch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// How the coefficients of two surfaces become one, as in KHR_physics_rigid_bodies. Where two surfaces differ, the one
/// that comes first in this list is taken.
enum class friction_combine : std::uint8_t { average, minimum, maximum, multiply };

/// The mode as it stands in files.
[[nodiscard]] constexpr const char* to_string(friction_combine mode) noexcept {
  switch (mode) {
    case friction_combine::average:
      return "average";
    case friction_combine::minimum:
      return "minimum";
    case friction_combine::maximum:
      return "maximum";
    case friction_combine::multiply:
      return "multiply";
  }
  return "unknown";
}

/// A surface, the same all over a body. The defaults are those of two bodies that make what planes do where no material
/// is known: 200 N/mm and 5 s/m, without friction.
struct material {
  std::string name{};                ///< for people; may be empty
  double stiffness_n_per_m = 4e5;    ///< of each point that presses, were the other body rigid
  double dissipation_s_per_m = 5.0;  ///< alpha of Hunt and Crossley: a slow blow of speed v comes back with 1 - alpha v
  double static_friction = 0.0;      ///< largest force along the surface, by what presses, of a contact that sticks
  double dynamic_friction = 0.0;     ///< the same of one that slips; at most the static one
  friction_combine combine = friction_combine::average;

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(name); }
};

/// Says which number is out of range and what would do.
/// @return invalid_argument
[[nodiscard]] ASPERITY_API result<void> check(const material& m);

/// What two surfaces make of a touch.
struct surface_pair {
  double stiffness_n_per_m = 2e5;
  double dissipation_s_per_m = 5.0;
  double static_friction = 0.0;
  double dynamic_friction = 0.0;
};

/// Two surfaces as springs in series: 1/k = 1/k_a + 1/k_b. Each takes the share s_a = k_b / (k_a + k_b) of the depth,
/// and alpha = s_a alpha_a + s_b alpha_b: the softer body decides. The laws of both, k_a x_a (1 + 1.5 alpha_a d') with
/// the speed d' at which the bodies close, have the same force and depths that add up to d; this is their sum to first
/// order in d'. Coefficients of friction are combined by the stronger of the two modes.
/// @pre check(a), check(b)   @rt safe
/// @source dissipation: Simbody's Hunt-Crossley contact; modes: KHR_physics_rigid_bodies
[[nodiscard]] ASPERITY_API surface_pair combined(const material& a, const material& b) noexcept;

/// The same where a body's material may be unknown: that body takes on the other's friction and dissipation and gives
/// way by nothing. Nothing where neither is known.
[[nodiscard]] ASPERITY_API std::optional<surface_pair> combined(const std::optional<material>& a,
                                                                const std::optional<material>& b) noexcept;

/// The pairs that the probe makes with each fixed body, in their order; nothing for a pair of which nothing is known.
using surface_pairs = std::vector<std::optional<surface_pair>>;

/// Materials to begin with: steel, wood, rubber, ice. Their sources are in docs/how-to/materials.md.
[[nodiscard]] ASPERITY_API std::span<const material> material_presets();
/// The preset of this name. @return invalid_argument, with the names that there are
[[nodiscard]] ASPERITY_API result<material> preset_material(std::string_view name);

}  // namespace asperity
