// From all support planes that a renderer tells to the few that the device thread needs until the next contact.
#pragma once

#include <algorithm>
#include <cstddef>
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
};

/// The selection for a contact loop of this period.
/// @param scale workspace_map::scale: a hand's way is longer in a world that it is enlarged into
/// @pre period_ns > 0, scale > 0
[[nodiscard]] inline plane_selection selection_for(std::int64_t period_ns, double scale = 1.0) noexcept {
  constexpr double turn_rad_per_s = 5.0;
  constexpr double slide_m_per_s = 0.1;
  const double period_s = 1e-9 * static_cast<double>(period_ns);
  plane_selection out;
  out.tilt_rad = turn_rad_per_s * period_s;
  out.slide_m = std::max(1.0, scale) * slide_m_per_s * period_s;
  return out;
}

/// Says which setting is out of range and what would do.
[[nodiscard]] ASPERITY_API result<void> check(const plane_selection& s);

/// The planes that become active first under small motions of the probe, per body and direction. Directions are taken
/// from the deepest plane that has none yet; each test motion is made for every direction before the next, so that a
/// full list lacks diagonals and not a wall.
/// The same candidates in the same order give the same planes.
/// @param most so many are taken
/// @return ok | capacity_reached | not_finite (a candidate has a number that is not finite; out is empty)
/// @pre check(s), most <= most_support_planes   @rt safe
[[nodiscard]] ASPERITY_API status select_planes(std::span<const support_plane> candidates, const plane_selection& s,
                                                support_planes& out, std::size_t most = most_selected_planes) noexcept;

}  // namespace asperity
