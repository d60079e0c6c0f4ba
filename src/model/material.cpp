#include "asperity/model/material.hpp"

#include <algorithm>
#include <array>

namespace asperity {

namespace {

[[nodiscard]] double combine(double a, double b, friction_combine mode) noexcept {
  switch (mode) {
    case friction_combine::average:
      return 0.5 * (a + b);
    case friction_combine::minimum:
      return std::min(a, b);
    case friction_combine::maximum:
      return std::max(a, b);
    case friction_combine::multiply:
      return a * b;
  }
  return 0.0;
}

}  // namespace

result<void> check(const material& m) {
  const auto bad = [&](const std::string& what) {
    return error{error_code::invalid_argument, "material" + (m.name.empty() ? "" : " '" + m.name + "'") + ": " + what};
  };
  if (!(m.stiffness_n_per_m >= 100.0 && m.stiffness_n_per_m <= 1e7)) {
    return bad("the stiffness must be from 100 to 1e7 N/m");
  }
  if (!(m.dissipation_s_per_m >= 0.0 && m.dissipation_s_per_m <= 100.0)) {
    return bad("the dissipation must be from 0 to 100 s/m");
  }
  if (!(m.static_friction >= 0.0 && m.static_friction <= 10.0)) return bad("the static friction must be from 0 to 10");
  if (!(m.dynamic_friction >= 0.0 && m.dynamic_friction <= m.static_friction)) {
    return bad("the dynamic friction must be from 0 to the static one");
  }
  return {};
}

surface_pair combined(const material& a, const material& b) noexcept {
  const double sum = a.stiffness_n_per_m + b.stiffness_n_per_m;
  const double share_a = b.stiffness_n_per_m / sum, share_b = a.stiffness_n_per_m / sum;
  const friction_combine mode = std::min(a.combine, b.combine);
  return {.stiffness_n_per_m = a.stiffness_n_per_m * share_a,
          .dissipation_s_per_m = share_a * a.dissipation_s_per_m + share_b * b.dissipation_s_per_m,
          .static_friction = combine(a.static_friction, b.static_friction, mode),
          .dynamic_friction = combine(a.dynamic_friction, b.dynamic_friction, mode)};
}

std::optional<surface_pair> combined(const std::optional<material>& a, const std::optional<material>& b) noexcept {
  if (a && b) return combined(*a, *b);
  if (!a && !b) return std::nullopt;
  const material& known = a ? *a : *b;
  return surface_pair{.stiffness_n_per_m = known.stiffness_n_per_m,
                      .dissipation_s_per_m = known.dissipation_s_per_m,
                      .static_friction = known.static_friction,
                      .dynamic_friction = known.dynamic_friction};
}

std::span<const material> material_presets() {
  static const std::array<material, 4> presets{{
      {"steel", 4e5, 0.3, 0.6, 0.4, friction_combine::minimum},
      {"wood", 1e5, 1.0, 0.4, 0.2, friction_combine::minimum},
      {"rubber", 3e3, 2.0, 1.0, 0.8, friction_combine::minimum},
      {"ice", 8.5e4, 1.0, 0.1, 0.03, friction_combine::minimum},
  }};
  return presets;
}

result<material> preset_material(std::string_view name) {
  std::string names;
  for (const material& m : material_presets()) {
    if (m.name == name) return m;
    names += (names.empty() ? "" : ", ") + m.name;
  }
  return error{error_code::invalid_argument, "there is no material '" + std::string(name) + "': take one of " + names};
}

}  // namespace asperity
