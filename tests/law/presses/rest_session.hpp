// A hand that rests on a body through device, coupling and contact: how much of what it feels is vibration?
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/vibration_monitor.hpp"
#include "law/presses/press_session.hpp"
#include "law/presses/press_touch.hpp"

namespace asperity::presses {

/// The grips that a rest is tried with: the ends of the range that the simulated device has presets for, and between.
inline constexpr std::array<std::string_view, 3> grips{"soft", "usual", "firm"};

/// How a hand comes to rest. It pulls the handle `way_m` beyond the touch and keeps it there.
struct rest_rules {
  std::size_t grip = 1;  ///< index in grips
  double way_m = 0.01;   ///< of the hand beyond the first touch, along the press
  std::int64_t contact_period_ns = 1'000'000;
  std::int64_t device_period_ns = 1'000'000;
  bool one_period_late = true;  ///< contacts take their whole period
  double plane_stiffness_n_per_m = contact_law{}.stiffness_n_per_m;
  bool guard = true;  ///< the passivity guard, which must not be needed
  double ramp_s = 0.5, settle_s = 0.3, rest_s = 1.0;
};

struct rest_result {
  rest_rules rules;
  std::uint64_t touch = 0;
  vibration_report heard;      ///< by a monitor that listens from the end of settle_s on
  double largest_n = 0.0;      ///< on the hand
  double deepest_m = 0.0;      ///< overlap of the whole session, at the poses of its contacts
  double step_n_per_ms = 0.0;  ///< fastest change of the force on the hand, from the end of settle_s on
  double rest_m = 0.0;         ///< deepest_m from the end of settle_s on
  double slides_m = 0.0;       ///< how far the probe goes from where it was at the end of settle_s
  double surplus_j = 0.0;      ///< most energy that the hand received beyond what it had lent
  bool ended_early = false;    ///< the gate shut
  /// Nothing was measured: the hand never came to rest, for instance where the probe slides off.
  [[nodiscard]] bool restless() const noexcept { return heard.measurements == 0; }
  /// More vibration than a hand should be given: above 60 Hz, more than a hundredth of the mean and than 5 mN or
  /// 0.5 mN m.
  [[nodiscard]] bool trembles() const noexcept { return heard.force.excessive || heard.torque.excessive; }
};

/// One session.
/// @param centre_of_mass_a of the probe's model: the handle is there
[[nodiscard]] rest_result rest_session(render_function render, const press_touch& touch, const vec3& centre_of_mass_a,
                                       const rest_rules& rules, std::uint64_t seed);

/// All rests of one pair.
struct rest_row {
  std::string probe, fixed;
  std::vector<rest_result> rests;
  double seconds = 0.0;
};

/// Draws the rules of a rest: a way of 2 to 30 mm, a grip, and a rate of 200 Hz to 4 kHz.
[[nodiscard]] rest_rules drawn_rest(std::uint64_t seed, const std::string& pair, std::uint64_t touch);

void print_rest_heading(std::FILE* to);
/// One line for the pair, and one for each rest that trembles.
void print_row(std::FILE* to, const rest_row& row);

}  // namespace asperity::presses
