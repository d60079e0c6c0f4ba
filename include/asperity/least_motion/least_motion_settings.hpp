// Settings of the force model of least motion, without the model.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "asperity/core/status.hpp"

namespace asperity {

/// Settings of least_motion.
struct least_motion_settings {
  double stiffness_n_per_m = 2000.0;  ///< k: of a contact, however many samples touch
  /// Over about this depth a contact's stiffness comes up to k, m. 0: softness_for() the period and the bodies' texels.
  double softness_m = 0.0;
  /// Where ways out compete, as on a ridge, the force turns from one to the other by at most this many times k per
  /// metre. At least 2. 0: softness_for() the period.
  double sharpness = 0.0;
  /// Ways out turn as well, on a spring of k times the square of this, m: what is wedged, or rocks on a face, is let
  /// out by a turn about where the bodies are close. The shorter, the softer a contact beside that place. 0: four times
  /// the way from the probe's centre of mass to its furthest point.
  double turn_arm_m = 0.0;
  double period_s = 1e-3;  ///< of the loop that asks, for what is automatic
  /// Readings of fields, or of their bounds, that a tick may spend; a reading takes 50 to 100 ns. Where they do not do,
  /// ways out may be missing: the tick answers capacity_reached. Nearly all contacts take less than 100,000;
  /// interlocked relief of whole faces takes a million.
  std::size_t most_readings = 2'000'000;
  std::size_t most_samples = 32'768;  ///< that may touch at one way out
};

/// How soft contacts are: see least_motion_settings.
struct contact_softness {
  double softness_m = 0.0;
  double sharpness = 0.0;
};

/// What a loop of this period can follow: a hand of 50 mm/s covers a softness in three ticks, and a quarter of a texel
/// at most, so that the texture stays. 15 um and 4 k at 1 kHz, 1.5 um and 12 k at 10 kHz.
[[nodiscard]] inline contact_softness softness_for(double period_s, double texel_m) noexcept {
  constexpr double speed_m_per_s = 0.05;
  const double travel_m = speed_m_per_s * period_s;
  contact_softness out;
  out.softness_m = std::max(1e-6, std::min(0.3 * travel_m, 0.25 * texel_m));
  out.sharpness = std::clamp(4.0 * std::sqrt(50e-6 / travel_m), 3.0, 12.0);
  return out;
}

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const least_motion_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "least motion: " + what}; };
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m > 0.0)) {
    return bad("stiffness_n_per_m must be a finite number above 0");
  }
  if (!(std::isfinite(s.softness_m) && s.softness_m >= 0.0)) {
    return bad("softness_m must be a finite length, or 0 for automatic");
  }
  if (!(s.sharpness == 0.0 || (std::isfinite(s.sharpness) && s.sharpness >= 2.0))) {
    return bad("sharpness must be a finite number of at least 2, or 0 for automatic");
  }
  if (!(std::isfinite(s.turn_arm_m) && s.turn_arm_m >= 0.0)) {
    return bad("turn_arm_m must be a finite length, or 0 for automatic");
  }
  if (!(std::isfinite(s.period_s) && s.period_s > 0.0)) return bad("period_s must be a finite time above 0");
  if (s.most_readings < 1000) return bad("most_readings must be 1000 or more");
  if (s.most_samples < 64) return bad("most_samples must be 64 or more");
  return {};
}

}  // namespace asperity
