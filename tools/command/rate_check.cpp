#include "rate_check.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "asperity/control/probe_motion.hpp"
#include "cpu_clock.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

constexpr int most_ticks = 200, least_ticks = 5;
constexpr double longest_s = 1.0 / 3.0;
constexpr double press_m = 1e-3;  // of the coupling's spring
constexpr double slide_m = 2e-3, slide_hz = 5.0;

struct lent_renderer {
  any_renderer* feel;
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept { return feel->step(at, out); }
};

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::optional<double> rate_within(double tick_s) {
  constexpr double share = 0.8;
  constexpr std::array usual_hz{10'000.0, 8000.0, 5000.0, 4000.0, 2500.0, 2000.0, 1250.0, 1000.0,
                                800.0,    500.0,  400.0,  250.0,  200.0,  125.0,  100.0};
  const auto* const found =
      std::find_if(usual_hz.begin(), usual_hz.end(), [&](double hz) { return tick_s * hz <= share; });
  return found == usual_hz.end() ? std::nullopt : std::optional(*found);
}

rate_check check_rate(any_renderer& feel, const scene_placement& placement, const pose& touch_T_wa,
                      const control_settings& control, const loop_periods& periods) {
  const auto shared = std::make_unique<exchange>();
  contact_loop contact(lent_renderer{&feel}, placement, *shared, selection_for(periods.renewal_ns(), control.map.scale),
                       laws_of(control));
  probe_motion motion(control.probe, control.coupling, laws_of(control), control.substeps, control.friction);
  const pose touch_T_wc = touch_T_wa * placement.T_ac();
  motion.place(touch_T_wc);

  const double step_s = 1e-9 * static_cast<double>(periods.renewal_ns());
  std::vector<double> seconds, processor_s;
  seconds.reserve(most_ticks);
  processor_s.reserve(most_ticks);
  const double begin_s = wall_seconds();
  for (int i = 0; i < most_ticks; ++i) {
    const std::int64_t now_ns = i * periods.renewal_ns();
    shared->poses.back() = {motion.probe().state().T_wc, now_ns, motion.pull()};
    shared->poses.publish();
    const double tick_begin_s = wall_seconds(), processor_begin_s = cpu_seconds();
    static_cast<void>(contact.tick(now_ns));
    processor_s.push_back(cpu_seconds() - processor_begin_s);
    const double tick_end_s = wall_seconds();
    seconds.push_back(tick_end_s - tick_begin_s);
    if (tick_end_s - begin_s > longest_s && i + 1 >= least_ticks) break;
    static_cast<void>(shared->contacts.refresh());
    pose target = touch_T_wc;
    // Along a line that is oblique to both horizontal axes, as the simulated hand's.
    const double along_m = slide_m * std::sin(2.0 * 3.14159265358979 * slide_hz * step_s * (i + 1));
    target.position += vec3(0.8 * along_m, 0.6 * along_m, -press_m * std::min(1.0, (i + 1) / 20.0));
    static_cast<void>(motion.move(step_s, target, 1.0, shared->contacts.front()));
  }

  // Points that are followed from tick to tick are lost on such a way: a session shall not begin with them.
  pose away_T_wa = touch_T_wa;
  away_T_wa.position.z += 1e3;
  tick unused;
  static_cast<void>(feel.step({away_T_wa, placement.T_wb}, unused));

  rate_check out{.period_s = 1e-9 * static_cast<double>(periods.contact_ns), .tick = summarise(std::move(seconds))};
  out.processor_p99_s = summarise(std::move(processor_s)).p99_s;
  out.kept = out.tick.p99_s <= out.period_s;
  if (!out.kept) out.kept_rate_hz = rate_within(std::max(out.processor_p99_s, out.tick.p50_s));
  return out;
}

std::optional<unsigned> more_threads(const render_options& chosen, unsigned processors) {
  constexpr unsigned others = 2, most = 4;  // the device thread and the application; beyond four little is gained
  const unsigned could = std::min(most, processors > others ? processors - others : 1);
  const bool more = formulation_name(chosen) == "planes" && could > chosen.threads;
  return more ? std::optional(could) : std::nullopt;
}

std::string advice_for(std::optional<double> kept_rate_hz, std::optional<unsigned> threads) {
  std::string options;
  if (threads) options += "--threads " + std::to_string(*threads) + ", ";
  if (kept_rate_hz) options += "--contact-rate " + brief(*kept_rate_hz) + ", ";
  return "use " + options + (options.empty() ? "coarser models" : "or coarser models");
}

std::string to_text(const rate_check& checked) {
  const std::string tick = "contact loop: a tick takes " + time_text(checked.tick.p50_s) + " of " +
                           time_text(checked.period_s) + " here (p99 " + time_text(checked.tick.p99_s) +
                           "): the rate is ";
  if (checked.kept) return tick + "kept";
  if (checked.processor_p99_s <= checked.period_s) {
    return tick + "not kept, because other programs hold the processor: end some of them";
  }
  return tick + "not kept; " + advice_for(checked.kept_rate_hz, checked.threads);
}

}  // namespace asperity::command
