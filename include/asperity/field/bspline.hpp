// Weights of uniform B-splines, with their derivatives.
#pragma once

#include <cstddef>

namespace asperity::detail {

/// Weights of the cubic B-spline for four nodes at -1, 0, 1, 2 and a place f between 0 and 1, in units of the pitch.
struct cubic_weights {
  double value[4];
  double slope[4];
  double bend[4];  ///< second derivative

  explicit cubic_weights(double f) noexcept {
    const double g = 1.0 - f;
    value[0] = g * g * g / 6.0;
    value[1] = 2.0 / 3.0 + f * f * (0.5 * f - 1.0);
    value[2] = 2.0 / 3.0 + g * g * (0.5 * g - 1.0);
    value[3] = f * f * f / 6.0;
    slope[0] = -0.5 * g * g;
    slope[1] = f * (1.5 * f - 2.0);
    slope[2] = -g * (1.5 * g - 2.0);
    slope[3] = 0.5 * f * f;
    bend[0] = g;
    bend[1] = 3.0 * f - 2.0;
    bend[2] = 3.0 * g - 2.0;
    bend[3] = f;
  }
};

/// Weights of the quadratic B-spline for three nodes at -1, 0, 1 and a place f between -1/2 and 1/2.
struct quadratic_weights {
  double value[3];
  double slope[3];

  explicit quadratic_weights(double f) noexcept {
    value[0] = 0.5 * (0.5 - f) * (0.5 - f);
    value[1] = 0.75 - f * f;
    value[2] = 0.5 * (0.5 + f) * (0.5 + f);
    slope[0] = f - 0.5;
    slope[1] = -2.0 * f;
    slope[2] = f + 0.5;
  }
};

}  // namespace asperity::detail
