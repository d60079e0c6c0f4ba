// What a body's surface is like to touch, and what two surfaces make of a touch.
#pragma once

#include <algorithm>
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

/// What a surface, or a part of one, is like to touch. The defaults are those of two bodies that make what planes do where no material
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

/// Most materials of one body: its first one, and those of its map.
inline constexpr std::size_t most_materials = 8;

/// Which material each texel of a body's haptic texture is of. Number 0 is the body's first material,
/// textured_model::surface; number i is others[i - 1]. Without `others` there is no map.
struct material_map {
  std::vector<material> others;        ///< at most most_materials - 1
  std::vector<std::uint8_t> texels{};  ///< a number for each texel, in the order of haptic_texture::texels

  [[nodiscard]] bool empty() const noexcept { return others.empty(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(others, texels); }
};

/// What two parts of two surfaces make of a touch, where one of the bodies has a material_map.
struct mapped_pair {
  std::uint32_t body = 0;     ///< of the fixed body: its place in surface_pairs
  std::uint8_t of_probe = 0;  ///< number of the material of the probe, and ...
  std::uint8_t of_body = 0;   ///< ... of the body
  surface_pair pair{};

  /// Grows with the body, then the probe's material, then the body's.
  [[nodiscard]] constexpr std::uint64_t key() const noexcept {
    return std::uint64_t{body} << 16U | std::uint64_t{of_probe} << 8U | of_body;
  }
};

/// The pairs that the probe makes with each fixed body, in their order; nothing for a pair of which nothing is known.
/// They are those of the bodies' first materials. `mapped` has the others, where bodies have maps.
struct surface_pairs : std::vector<std::optional<surface_pair>> {
  using std::vector<std::optional<surface_pair>>::vector;

  /// The pairs with a material that is not the first of its body, in the order of mapped_pair::key().
  std::vector<mapped_pair> mapped{};

  /// The pair of these two materials; null where there is no such pair in `mapped`. @rt safe
  [[nodiscard]] const surface_pair* find(std::uint32_t body, std::uint8_t of_probe,
                                         std::uint8_t of_body) const noexcept {
    const std::uint64_t key = mapped_pair{body, of_probe, of_body, {}}.key();
    const auto at = std::lower_bound(mapped.begin(), mapped.end(), key,
                                     [](const mapped_pair& p, std::uint64_t k) { return p.key() < k; });
    return at != mapped.end() && at->key() == key ? &at->pair : nullptr;
  }
};

/// Materials to begin with: steel, wood, rubber, ice. Their sources are in docs/how-to/materials.md.
[[nodiscard]] ASPERITY_API std::span<const material> material_presets();
/// The preset of this name. @return invalid_argument, with the names that there are
[[nodiscard]] ASPERITY_API result<material> preset_material(std::string_view name);

}  // namespace asperity
