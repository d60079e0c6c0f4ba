// Values of a depth backend's automatic settings for a pair of bodies.
#pragma once

#include <algorithm>
#include <numbers>

#include "asperity/window/window_depth_settings.hpp"
#include "model/texture_scale.hpp"

namespace asperity::detail {

/// Values of the automatic settings for a pair of bodies. They are constant and depend on no pose.
struct pair_scale {
  double tau_m = 0.0;
  double reference_area_m2 = 0.0;
  double wavelength_m = 0.0;
  double texel_m = 0.0;
};

[[nodiscard]] inline pair_scale scale_of(const window_depth_settings& s, const texture_scale& a, const texture_scale& b,
                                         double smaller_diagonal_m) noexcept {
  pair_scale out;
  out.tau_m = s.tau_m > 0.0
                  ? s.tau_m
                  : std::max(0.02 * std::max(a.peak_to_valley_m, b.peak_to_valley_m), 2e-5 * smaller_diagonal_m);
  const double curvature = a.peak_curvature_per_m + b.peak_curvature_per_m;
  out.reference_area_m2 =
      s.reference_area_m2 > 0.0 ? s.reference_area_m2 : 2.0 * std::numbers::pi * out.tau_m / curvature;
  out.wavelength_m = a.wavelength_m > 0.0 && b.wavelength_m > 0.0 ? std::min(a.wavelength_m, b.wavelength_m)
                                                                  : std::max(a.wavelength_m, b.wavelength_m);
  out.texel_m = std::max(a.texel_m, b.texel_m);
  return out;
}

/// Step of the central differences for a sample pitch p: large enough to average over the grid, small enough to keep
/// the texture.
/// @source science, sections 3.2 and 8
[[nodiscard]] inline double difference_step(const window_depth_settings& s, const pair_scale& pair,
                                            double pitch_m) noexcept {
  if (s.difference_step_m > 0.0) return s.difference_step_m;
  const double wanted = pair.wavelength_m > 0.0 ? std::min(pitch_m, pair.wavelength_m / 20.0) : pitch_m;
  return std::max({0.5 * pitch_m, wanted, 0.5 * pair.texel_m});
}

}  // namespace asperity::detail
