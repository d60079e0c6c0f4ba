// The soft maximum over the window: one smooth potential with its exact gradient and its curvature.
//
//   delta_tau = tau ln( sum_i mu_i exp(d_i / tau) p^2 / A0 ),   d_i = h_A - h_B at sample i, mu_i its taper
//   g         = sum_i w_i g_i,   g_i = d(d_i + tau ln mu_i)/dq,   w_i = share of sample i in the sum
//   C         = (sum_i w_i g_i g_i^T - g g^T) / tau,   positive semidefinite
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "asperity/core/spatial.hpp"

namespace asperity::detail {

struct soft_maximum {
  double depth_m = 0.0;
  vec6 gradient{};
  mat6 curvature{};
  bool found = false;  ///< false where no sample has any weight
};

/// Soft maximum of effective depths d_i + tau ln mu_i, m; minus infinity leaves a sample out.
/// @param area_ratio  p^2 / A0
/// @param gradient    gradient(i) of effective depth i; only asked for where it counts
/// @rt safe   @source science, section 3.2 (LSE)
template <class Gradient>
[[nodiscard]] soft_maximum soft_max(std::span<const double> effective_m, double tau_m, double area_ratio,
                                    Gradient gradient) noexcept {
  constexpr double nothing = -std::numeric_limits<double>::infinity();
  // The largest effective depth is the reference, so that no exponent overflows and the sum never vanishes.
  double top = nothing;
  for (const double e : effective_m) top = e > top ? e : top;
  soft_maximum out;
  if (!(top > nothing)) return out;

  // exp(-40) of the deepest sample's weight is below the rounding of the sum.
  constexpr double negligible = 40.0;
  double sum = 0.0;
  vec6 first{};  // sum w (g_i - g_ref): a reference among the g_i keeps the digits of the covariance
  vec6 reference{};
  mat6 second{};
  bool have_reference = false;
  for (std::size_t i = 0; i < effective_m.size(); ++i) {
    const double x = (effective_m[i] - top) / tau_m;
    if (!(x >= -negligible)) continue;
    const double w = std::exp(x);
    const vec6 g = gradient(i);
    if (!have_reference) reference = g;
    have_reference = true;
    const vec6 offset = g - reference;
    sum += w;
    first += w * offset;
    add_outer(second, w, offset);
  }
  const vec6 mean = 1.0 / sum * first;
  out.found = true;
  out.depth_m = top + tau_m * std::log(sum * area_ratio);
  out.gradient = reference + mean;
  out.curvature = 1.0 / (tau_m * sum) * second;
  add_outer(out.curvature, -1.0 / tau_m, mean);
  return out;
}

}  // namespace asperity::detail
