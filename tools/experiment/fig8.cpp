// The paper's Fig. 8: two striped blocks, interlocked, one turned about the contact normal. It rises, and a torque
// opposes the turn.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "experiment.hpp"
#include "turned_block.hpp"

namespace asperity::experiment {
namespace {

constexpr double height_m = 2.0 * models::ridge_amplitude_m;

// Root mean square of f over the samples that `where` picks; NaN, which no statement takes, where it picks none.
template <class Where, class F>
double rms(const std::vector<turned_sample>& samples, Where where, F f) {
  double sum = 0.0, count = 0.0;
  for (const turned_sample& s : samples) {
    if (!where(s)) continue;
    sum += f(s) * f(s);
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

// The angle theta_s for which P sin(pi/2 min(|theta| / theta_s, 1)) fits the rise best, P being its mean where it has
// long been level: closed form of the rise, its only parameter left open.
double fitted_saturation(const std::vector<turned_sample>& samples) {
  double level = 0.0, count = 0.0;
  for (const turned_sample& s : samples) {
    if (std::abs(s.angle_rad) < 1.15 * saturation_angle_rad()) continue;
    level += s.rise_m;
    count += 1.0;
  }
  level /= count;
  double best = 0.0, least = 1e300;
  for (double tried = 0.6; tried < 1.6; tried += 0.002) {
    const double at = tried * saturation_angle_rad();
    double error = 0.0;
    for (const turned_sample& s : samples) {
      const double e =
          s.rise_m - level * std::sin(0.5 * std::numbers::pi * std::min(std::abs(s.angle_rad) / at, 1.0));
      error += e * e;
    }
    if (error < least) {
      least = error;
      best = at;
    }
  }
  return best;
}

}  // namespace

result<findings> run_fig8(workbench& bench) {
  result<scene> bodies = block_on_block(bench);
  if (!bodies) return bodies.error();
  turning how;
  if (bench.brief()) how = {.reach_rad = 0.13, .speed_rad_per_s = 0.4};
  const rise_by_brute_force hard(how.reach_rad + 0.01);

  findings out;
  const double peak_arm = std::abs(torque_arm_m(1e-9));
  for (const variant& kind : bench.variants()) {
    if (const result<void> on = bench.go_on(); !on) return on.error();
    bench.progress("fig8, " + kind.says, 0.0);
    result<command::chosen_renderer> feel = bench.make_renderer(*bodies, kind);
    if (!feel && kind.may_be_missing) {
      out.notes.push_back(kind.name + " was left out: " + feel.error().message);
      continue;
    }
    if (!feel) return feel.error();
    const result<std::vector<turned_sample>> turned = turn_block(std::move(feel).value(), how);
    if (!turned) return turned.error();
    const std::vector<turned_sample>& all = *turned;
    const auto any = [](const turned_sample&) { return true; };
    const auto between_limits = [](const turned_sample& s) {
      return std::abs(s.angle_rad) > 0.004 && std::abs(s.angle_rad) < 0.09;
    };
    const auto level = [](const turned_sample& s) { return std::abs(s.angle_rad) > 1.15 * saturation_angle_rad(); };
    std::size_t opposes = 0, judged = 0;
    for (const turned_sample& s : all) {
      if (!between_limits(s)) continue;
      ++judged;
      opposes += s.torque_n_m * s.angle_rad < 0.0 ? 1U : 0U;
    }
    const auto arm_error = [](const turned_sample& s) { return s.torque_n_m - s.force_n * torque_arm_m(s.angle_rad); };
    const auto arm = [](const turned_sample& s) { return s.force_n * torque_arm_m(s.angle_rad); };
    out.statements.push_back(at_most("rise_" + kind.name, "RMS error of the rise against brute force over 2a",
                                     rms(all, any, [&](const turned_sample& s) { return s.rise_m - hard(s.angle_rad); }) /
                                         height_m,
                                     0.01));
    out.statements.push_back(at_most("saturation_" + kind.name, "saturation angle over lambda / (2 w), off by",
                                     std::abs(fitted_saturation(all) / saturation_angle_rad() - 1.0), 0.05));
    out.statements.push_back(at_least("opposes_" + kind.name, "share of samples in which the torque opposes",
                                      static_cast<double>(opposes) / static_cast<double>(judged), 1.0));
    out.statements.push_back(at_most("torque_" + kind.name, "RMS error of the torque over its RMS",
                                     rms(all, between_limits, arm_error) / rms(all, between_limits, arm), 0.05));
    out.statements.push_back(
        at_most("level_torque_" + kind.name, "RMS torque in saturation over its largest",
                rms(all, level, [](const turned_sample& s) { return s.torque_n_m; }) / (turned_block_press_n * peak_arm),
                0.01));
    table t{"fig8_" + kind.name, {"time_s", "hand_rad", "angle_rad", "rise_m", "force_n", "torque_n_m", "theory_rise_m", "theory_torque_n_m"}, {}};
    for (const turned_sample& s : all)
      t.rows.push_back({s.time_s, s.hand_rad, s.angle_rad, s.rise_m, s.force_n, s.torque_n_m, hard(s.angle_rad), arm(s)});
    out.tables.push_back(std::move(t));
  }
  return out;
}

}  // namespace asperity::experiment
