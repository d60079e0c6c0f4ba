#include "trial.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace asperity::experiment {
namespace {

/// Another renderer's wrench without its stiffness.
class held_wrench {
 public:
  explicit held_wrench(any_renderer inner) : inner_(std::move(inner)) {}

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const status s = inner_.step(at, out);
    out.force.stiffness = {};
    return s;
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return inner_.scene(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return inner_.memory_bytes(); }

 private:
  any_renderer inner_;
};

}  // namespace

result<trial_log> run_trial(any_renderer feel, trial wanted) {
  if (wanted.hold_wrench) {
    feel = any_renderer(held_wrench(std::move(feel)));
  }
  const vec3 centre_a = feel.scene().probe->mass.centre_of_mass;
  const quat& r = wanted.T_wa_start.rotation;
  wanted.control.map = {.T_wd = pose{}, .scale = 1.0, .T_ha = {r, -(r * centre_a)}};

  any_device hand(scripted_hand(std::move(wanted.script), wanted.grip));
  if (const result<void> opened = hand.open(); !opened) return opened.error();
  trial_log log;
  log.ticks.reserve(static_cast<std::size_t>(std::ceil(1000.0 * wanted.seconds)) + 256);
  command::progress_line silent(true);
  result<command::session_outcome> ended =
      command::run_session({.feel = std::move(feel),
                            .placement = {std::move(wanted.T_wb), centre_a},
                            .device = std::move(hand),
                            .control = wanted.control,
                            .clock = command::session_clock::virtual_time,
                            .seconds = wanted.seconds,
                            .periods = {.contact_ns = wanted.contact_period_ns},
                            .contact_one_period_late = wanted.contact_one_period_late,
                            .on_tick = [&](const session_record& tick) -> result<void> {
                              if (log.ticks.size() < log.ticks.capacity()) log.ticks.push_back(tick);
                              return {};
                            }},
                           silent);
  if (!ended) return ended.error();
  if (ended->interrupted) return error{error_code::cancelled, "interrupted: the experiment was not finished"};
  if (ended->fault != gate_fault::none && !wanted.gate_may_shut) {
    return error{error_code::invalid_argument, "the output gate shut after " + std::to_string(ended->ended_at_s) +
                                                   " s (" + to_string(ended->fault) +
                                                   "): the experiment's motion or settings are out of range"};
  }
  log.ended = std::move(ended).value();
  const auto wanted_ticks = static_cast<std::size_t>(log.ended.device.ticks);
  if (log.ticks.size() > wanted_ticks) log.ticks.resize(wanted_ticks);  // without those in which the wrench winds down
  return log;
}

}  // namespace asperity::experiment
