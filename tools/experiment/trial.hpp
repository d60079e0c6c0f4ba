// One session of the whole pipeline, with a scripted hand, on the virtual clock.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "asperity/control/device_loop.hpp"
#include "asperity/control/session_record.hpp"
#include "scripted_hand.hpp"
#include "session.hpp"

namespace asperity::experiment {

/// Device period of every trial.
inline constexpr std::int64_t device_period_ns = loop_periods{}.device_ns;

/// What is done in a session. The device's base frame is the world's, and the handle sits at the probe's centre of mass
/// with the world's axes at the start: a wish's pose is where the hand wants the probe's centre of mass, its rotation
/// how far it has turned the probe from the start.
struct trial {
  pose T_wa_start{};
  std::vector<pose> T_wb;
  std::function<hand_wish(double t_s)> script;
  hand_grip grip{};
  double seconds = 1.0;
  std::int64_t contact_period_ns = loop_periods{}.contact_ns;
  bool contact_one_period_late = true;  ///< as on a real machine, where a contact takes its time to compute
  bool hold_wrench = false;    ///< the contact's wrench without its stiffness: what a loop without linear contacts does
  control_settings control{};  ///< its map is set by the trial
  bool gate_may_shut = false;  ///< that is an outcome, not an error: the log ends there, ended.fault says why
};

/// Every device tick, and what the loops took.
struct trial_log {
  std::vector<session_record> ticks;
  command::session_outcome ended;
};

/// @return the session's error, or that the output gate shut and why: in an experiment it never should
[[nodiscard]] result<trial_log> run_trial(any_renderer feel, trial wanted);

}  // namespace asperity::experiment
