// From all support planes that a renderer tells to the few that the device thread needs until the next contact.
#pragma once

#include <cstdint>
#include <span>

#include "asperity/control/linear_contact.hpp"
#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// How far the probe is expected to move until the next contact, and which planes stand for one direction.
struct plane_selection {
  /// Tilt that is tried, rad, and eight times it. A hand turns at about 5 rad/s, so 5 T for a contact period of T: here
  /// 1 ms. With fewer or smaller tilts a face falls by more than a millimetre before its far corner is known.
  double tilt_rad = 0.005;
  /// Slide that is tried, m: a hand moves at about 0.1 m/s, so 0.1 T.
  double slide_m = 1e-4;
  /// Cosine between n_ab of two planes of one body above which they share a direction. Within 35 degrees planes replace
  /// each other when the probe tilts; further apart they hold the probe in different ways.
  double same_direction = 0.82;
  /// The contact period that tilt and slide are for, s. A contact_loop asks for gaps of three of them.
  double period_s = 1e-3;
};

/// The selection for a contact loop of this period.
/// @pre period_ns > 0
[[nodiscard]] inline plane_selection selection_for(std::int64_t period_ns) noexcept {
  constexpr double turn_rad_per_s = 5.0;
  constexpr double slide_m_per_s = 0.1;
  const double period_s = 1e-9 * static_cast<double>(period_ns);
  plane_selection out;
  out.tilt_rad = turn_rad_per_s * period_s;
  out.slide_m = slide_m_per_s * period_s;
  out.period_s = period_s;
  return out;
}

/// The gaps that a contact loop of this period has to know, m, where no point of the probe and of the hand is faster than
/// this now: a contact is handed over a period late and is used for another, and a hand starts to move within one. At
/// least half a millimetre.
[[nodiscard]] constexpr double gaps_for(double period_s, double point_m_per_s) noexcept {
  // A hand gains 0.2 m/s in three periods of 1 kHz: 67 m/s2, more than a tap of 20 mm at 6 Hz has.
  constexpr double periods = 3.0, sudden_m_per_s_per_s = 200.0, least_m = 5e-4;
  const double gaps_m = periods * period_s * (point_m_per_s + sudden_m_per_s_per_s * period_s);
  return gaps_m > least_m ? gaps_m : least_m;
}

/// Says which setting is out of range and what would do.
[[nodiscard]] ASPERITY_API result<void> check(const plane_selection& s);

/// The planes that become active first under small motions of the probe, per body and direction. Directions are taken
/// from the deepest plane that has none yet; each test motion is made for every direction before the next, so that a
/// full list lacks diagonals and not a wall. At most most_selected_planes are taken.
/// The same candidates in the same order give the same planes.
/// @return ok | capacity_reached | not_finite (a candidate has a number that is not finite; out is empty)
/// @pre check(s)   @rt safe
[[nodiscard]] ASPERITY_API status select_planes(std::span<const support_plane> candidates, const plane_selection& s,
                                                support_planes& out) noexcept;

}  // namespace asperity
