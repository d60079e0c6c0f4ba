// The paper's Fig. 7: a textured block drawn over the ridges of a gear.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "experiment.hpp"
#include "trial.hpp"

namespace asperity::experiment {
namespace {

using models::benchmark;

constexpr double drive_m_per_s = 7e-3;

/// What one kind of renderer makes of the motion.
struct drawn_block {
  std::vector<double> time_s, z_m, force_n;
};

// The block lies on the gear's crown, its own ridges across; the hand presses and draws along y.
result<trial_log> draw_over(workbench& bench, const variant& kind) {
  result<model_ptr> block = bench.benchmark(benchmark::block);
  if (!block) return block.error();
  result<model_ptr> gear = bench.benchmark(benchmark::gear);
  if (!gear) return gear.error();
  result<command::chosen_renderer> feel = bench.make_renderer({*block, {*gear}}, kind);
  if (!feel) return feel.error();

  const double rest_z_m = models::gear_radius_m + 0.5 * models::block_size_m[2];
  trial t;
  t.T_wa_start = {quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, rest_z_m + 2.5 * models::ridge_amplitude_m)};
  t.T_wb = {pose{}};
  t.seconds = bench.brief() ? 1.2 : 3.0;
  t.script = [start = t.T_wa_start](double t_s) {
    hand_wish wish;
    wish.T_dh.position = start.position;
    wish.T_dh.position.z -= 4e-3 * std::clamp(t_s / 0.2, 0.0, 1.0);
    wish.T_dh.position.y += drive_m_per_s * std::max(0.0, t_s - 0.25);
    return wish;
  };
  return run_trial(std::move(feel).value(), std::move(t));
}

}  // namespace

result<findings> run_fig7(workbench& bench) {
  findings out;
  figure f{"fig7", "The block rises and falls with each ridge.", {}};
  f.page.title = "A block drawn over a gear";
  f.page.caption = "Virtual clock.";
  f.page.x_label = "time (s)";
  f.page.panels = {{"height (mm)", {}}};
  for (const variant& kind : bench.variants()) {
    if (const result<void> on = bench.go_on(); !on) return on.error();
    bench.progress("fig7, " + kind.says, 0.0);
    const result<trial_log> log = draw_over(bench, kind);
    if (!log && kind.may_be_missing) {
      out.notes.push_back(kind.name + " was left out: " + log.error().message);
      continue;
    }
    if (!log) return log.error();
    drawn_block b;
    for (const session_record& r : log->ticks) {
      b.time_s.push_back(1e-9 * static_cast<double>(r.time_ns));
      b.z_m.push_back(1e3 * r.T_wa.position.z);
      b.force_n.push_back(glm::length(r.on_probe_w.force));
    }
    out.statements.push_back(at_least("touches_" + kind.name, "largest force, N",
                                      *std::max_element(b.force_n.begin(), b.force_n.end()), 0.1));
    f.page.x = b.time_s;
    f.page.panels[0].lines.push_back({kind.says, b.z_m});
  }
  out.figures.push_back(std::move(f));
  return out;
}

}  // namespace asperity::experiment
