// Settings of the force model of least motion, without the model.
#pragma once

#include <cstddef>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// Settings of least_motion.
struct least_motion_settings {
  double stiffness_n_per_m = 2000.0;  ///< k, of a contact, however many samples touch
  /// Depth over which a contact's stiffness grows to k, m. 0: softness_for() the period and the bodies' texels.
  double softness_m = 0.0;
  /// Where ways out compete, as on a ridge, the force turns from one to the other by at most this many times k per
  /// metre. At least 2. 0: softness_for() the period.
  double sharpness = 0.0;
  /// Ways out turn as well, on a spring of k times the square of this, m: a turn about where the bodies are close frees
  /// a probe that is wedged or rocks on a face. The shorter it is, the softer is a contact beside that place. 0: four
  /// times the distance from the probe's centre of mass to its furthest point.
  double turn_arm_m = 0.0;
  double period_s = 1e-3;  ///< of the loop that asks, for what is automatic
  /// Readings of fields, or of their bounds, that a tick may spend; a reading takes 50 to 100 ns. Where they are too
  /// few, ways out may be missing: the tick answers capacity_reached. Nearly all contacts take less than 100,000;
  /// interlocked relief of whole faces takes a million.
  std::size_t most_readings = 2'000'000;
  std::size_t most_samples = 32'768;  ///< samples that may touch at one way out
};

/// How soft contacts are: see least_motion_settings.
struct contact_softness {
  double softness_m = 0.0;
  double sharpness = 0.0;
};

/// The softness that a loop of this period can follow: a hand of 50 mm/s crosses it in three ticks. It is at most a
/// quarter of a texel, so that the texture is still felt. 15 um and 4 k at 1 kHz, 1.5 um and 12 k at 10 kHz.
[[nodiscard]] ASPERITY_API contact_softness softness_for(double period_s, double texel_m) noexcept;

/// Says which setting is out of range and what would do.
[[nodiscard]] ASPERITY_API result<void> check(const least_motion_settings& s);

}  // namespace asperity

namespace asperity::exits {

/// What a solve had to leave out.
struct exit_limits_hit {
  bool readings = false;   ///< least_motion_settings::most_readings: ways out may be missing
  bool marks = false;      ///< least_motion_settings::most_samples: the bed of one way out is incomplete
  bool unsettled = false;  ///< a way out with weight did not come to rest
  bool rounds = false;     ///< the weights still changed at the last round

  [[nodiscard]] bool any() const noexcept { return readings || marks || unsettled || rounds; }
};

}  // namespace asperity::exits
