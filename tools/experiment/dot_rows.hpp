// Rows of dots, each row with a spacing of its own, and how the shaking of the hand depends on it.
#pragma once

#include <cstddef>
#include <vector>

#include "stroking.hpp"

namespace asperity::experiment {

/// A plate with 18 rows of truncated cones along x, 2.4 mm apart; their spacing grows by a factor from row to row.
/// @source dimensions of the stimuli of Klatzky and Lederman, science, section 9
struct dot_rows {
  static constexpr std::size_t count = 18;
  static constexpr double height_m = 0.46e-3, top_diameter_m = 0.5e-3, base_diameter_m = 1.06e-3;
  static constexpr double smallest_m = 0.6e-3, largest_m = 9e-3;
  static constexpr double length_m = 36e-3;

  [[nodiscard]] static double spacing_m(std::size_t row);
  [[nodiscard]] static double y_m(std::size_t row);
  [[nodiscard]] static result<model_ptr> bake(workbench& bench);
  /// Spacing at which a ball just reaches the ground between two dots, in the geometric model of the literature.
  [[nodiscard]] static double drop_spacing_m(double ball_m);
};

/// One way over some rows at one speed and one force, there and back in turn. Added to what there is already.
void add_rows(stroking& how, const std::vector<std::size_t>& rows, double speed_m_per_s, double push_n, int first_felt);

/// Something measured over the spacing of the dots.
struct spacing_curve {
  std::vector<double> spacing_m, value;
};

/// The place of the largest value, between the rows too: of the curve smoothed over three rows, by a parabola over the
/// logarithm of the spacing. @pre three rows or more, evenly spaced by factors
struct curve_peak {
  double spacing_m = 0.0, value = 0.0;
};
[[nodiscard]] curve_peak peak_of(const spacing_curve& curve);

/// Exponent p of y ~ x^p by least squares. @pre all values above zero
[[nodiscard]] double power_law(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace asperity::experiment
