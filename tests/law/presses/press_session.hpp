// Presses by a simulated hand through device, coupling and contact: does the probe stay on its side?
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_settings.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/renderer.hpp"
#include "law/presses/press_touch.hpp"
#include "law/presses/true_exit.hpp"

namespace asperity::presses {

/// A renderer's step().
using render_function = std::function<status(const scene_pose& at, tick& out)>;

/// It as a session takes it.
struct rendered {
  const render_function* render;
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept { return (*render)(at, out); }
};

/// A hand that comes from before_m back along a touch's approach and goes beyond_m into the press, in approach_s. Device
/// and workspace leave room; what else the hand does is the caller's.
[[nodiscard]] simulated_settings hand_at(const press_touch& touch, const vec3& centre_of_mass_a, double before_m,
                                         double beyond_m, double approach_s, double strongest_n);

/// How a session presses. A firm hand pulls the handle along the touch's direction, from just before the touch, until
/// hand and coupling would hold `hand_n` against a wall.
struct session_rules {
  double hand_n = 20.0;
  double stiffness_n_per_m = 2000.0;  ///< of the contact, which the hand's way allows for
  double before_m = 2e-4;             ///< way from the first touch back along the approach where the session begins
  double ramp_s = 0.8, hold_s = 0.2;
  virtual_schedule when{};  ///< periods of the loops, and how late contacts are
  double weak_share = 0.5;
  double allowance_m = 1e-3;     ///< of the depth, for the models' errors and the motion between two ticks
  double looks_across_m = 2e-5;  ///< step of the difference that says which side of a body is the nearer one
};

struct session_result {
  bool passed = false;         ///< the probe went past half way through, or ended on the far side
  double passed_at_n = 0.0;    ///< largest force on the hand until then
  bool gave_way = false;       ///< somewhere the contact pushed by less than half of what its depth asks for
  double gave_way_at_n = 0.0;  ///< largest force on the hand until then
  double largest_n = 0.0;      ///< on the hand, of the whole session
  double last_n = 0.0;         ///< on the hand, at the end
  double deepest_m = 0.0;      ///< of the probe's touching point within the fixed original, until it passed
  double overlap_m = 0.0;      ///< largest of any point, as the contacts tell it
  bool ended_early = false;    ///< the gate shut
  tick_flag reported{};        ///< flags of all device ticks, until three after it passed
};

/// One session of one touch; it ends where the probe has passed. Whether it has is asked of the originals: the point of
/// the probe that touched first is followed in every device tick, and has passed where the fixed body's nearest surface
/// faces the way of the press, a quarter of the thickness away at least: a probe that slips round a body touches its
/// far side without having passed. At the end the shortest way out of the whole probe is asked for in the same way. The
/// true depth of the bodies is at least that point's depth: the contact has given way where its force is less than
/// weak_share k of it.
/// @param centre_of_mass_a of the probe's model: the handle is there
[[nodiscard]] session_result press_session(render_function render, const press_touch& touch,
                                           const vec3& centre_of_mass_a, const session_rules& rules, std::uint64_t seed,
                                           exit_search& originals);

/// All sessions of one pair under one renderer.
struct session_row {
  std::string probe, fixed;
  std::vector<session_result> sessions;
  double seconds = 0.0;
};

void print_session_heading(std::FILE* to);
/// One line. A session slips where the probe has not passed and the hand feels less than half of its force at the end:
/// it went aside, which a round or narrow body allows.
void print_row(std::FILE* to, const session_row& row);

}  // namespace asperity::presses
