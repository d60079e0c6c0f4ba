// Settings of the shared formulation: what depth backend and force model must agree on.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "asperity/core/status.hpp"

namespace asperity {

/// Settings of the shared formulation. SI units.
struct shared_settings {
  double stiffness_n_per_m = 2000.0;  ///< of a face that is met squarely

  /// Softness of the maximum, m. 0: 5 % of the larger relief of the two bodies, and at least half a thousandth of the
  /// smaller body's diagonal. The depth of a contact is told 0 to 2 tau too small; where two slopes meet, as on a
  /// ridge, the stiffness grows with 1 / tau. With less, a hand that moves at 50 mm/s meets slopes that a contact loop
  /// of 1 kHz cannot tell from jumps; with more, fine texture fades.
  double tau_m = 0.0;

  double facing_full = 0.92, facing_none = 0.75;    ///< -n_A . n_B between which a face's samples fade in
  double leaving_none = 0.5, leaving_full = 0.17;   ///< an edge or vertex has full weight while no direction along its
                                                    ///< surface leads further in than this cosine
  double crossing_none = 0.1, crossing_full = 0.3;  ///< sine between two edges between which their contact fades in
  double same_direction_rad = 25.0 * std::numbers::pi / 180.0;   ///< cells within this angle share one spring
  double other_direction_rad = 60.0 * std::numbers::pi / 180.0;  ///< beyond this angle each has its own
};

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const shared_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "shared settings: " + what}; };
  const auto rising = [](double a, double b) { return a >= 0.0 && a < b && b <= 1.0; };
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m >= 0.0)) {
    return bad("stiffness_n_per_m must be a finite number, 0 or more");
  }
  if (!(std::isfinite(s.tau_m) && s.tau_m >= 0.0)) return bad("tau_m must be a finite length, or 0 for automatic");
  if (!rising(s.facing_none, s.facing_full)) return bad("facing_none must be below facing_full, both cosines");
  if (!rising(s.leaving_full, s.leaving_none)) return bad("leaving_full must be below leaving_none, both cosines");
  if (!rising(s.crossing_none, s.crossing_full)) return bad("crossing_none must be below crossing_full, both sines");
  if (!(s.same_direction_rad > 0.0 && s.same_direction_rad < s.other_direction_rad &&
        s.other_direction_rad < std::numbers::pi)) {
    return bad("same_direction_rad must be above 0 and below other_direction_rad");
  }
  return {};
}

}  // namespace asperity
