#include "fig7_ride.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "striped_block.hpp"

namespace asperity::experiment {
namespace {

using models::benchmark;

constexpr double start_m = -2.0 * models::ridge_wavelength_m;          // in a notch, left of the middle
constexpr double middles_m = models::gear_radius_m + block_half_m[2];  // apart, at mid height of both
constexpr double shortest_rest_s = 0.05;

// Turned about x by this, what lies on the gear's crown and moves along y lies in the leaning plane.
double turn_of(const ride_settings& with) { return 0.5 * std::numbers::pi - with.lean_rad; }

double correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t from) {
  const auto n = static_cast<double>(a.size() - from);
  double mean_a = 0.0, mean_b = 0.0, ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = from; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  for (std::size_t i = from; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

}  // namespace

ride_axes axes_of(const ride_settings& with) {
  const double s = std::sin(with.lean_rad), c = std::cos(with.lean_rad);
  return {vec3(0.0, s, c), vec3(0.0, c, -s)};
}

result<ride> draw_over_gear(workbench& bench, const variant& kind, const ride_settings& with) {
  result<model_ptr> block = striped_block(bench);
  if (!block) return block.error();
  result<model_ptr> gear = bench.models().benchmark(benchmark::gear);
  if (!gear) return gear.error();
  result<any_renderer> feel = bench.make_renderer({*block, {*gear}}, kind);
  if (!feel) return feel.error();

  // The gear turns with the plane: a crest always points at the block.
  const ride_axes axes = axes_of(with);
  const quat turn = exp_rotation(vec3(turn_of(with), 0.0, 0.0));
  trial t;
  t.T_wb = {pose{turn, vec3(0.0)}};
  t.T_wa_start = {turn, start_m * axes.along - (middles_m + 3.0 * models::ridge_amplitude_m) * axes.into};
  t.seconds = with.seconds;
  t.contact_period_ns = with.contact_period_ns;
  t.contact_one_period_late = with.contact_one_period_late;
  t.control.probe = {with.probe_mass_kg, mat3(4e-4 * with.probe_mass_kg)};
  t.control.coupling.max_damping_n_s_per_m = 1e3;  // critical whatever the mass: the hand is rigid
  t.control.coupling.max_damping_n_m_s_per_rad = 1e3;
  const double push_m = 3.0 * models::ridge_amplitude_m + with.press_n / t.control.coupling.stiffness_n_per_m;
  t.script = [=, start = t.T_wa_start](double t_s) {
    const double driven_s = std::max(0.0, t_s - with.drive_from_s);
    hand_wish wish;
    wish.T_dh.position = start.position + push_m * std::clamp(t_s / with.touch_s, 0.0, 1.0) * axes.into;
    wish.T_dh.position += with.drive_m_per_s * driven_s * axes.along;
    wish.T_dh.position.x += with.sway_m * std::sin(2.0 * std::numbers::pi * driven_s / with.sway_period_s);
    return wish;
  };
  const result<trial_log> log = run_trial(std::move(feel).value(), t);
  if (!log) return log.error();

  ride out;
  for (const session_record& r : log->ticks) {
    const vec3 moved = r.T_wa.position - t.T_wa_start.position;
    const vec3 hand = r.T_wa_target.position - t.T_wa_start.position;
    const wrench& w = r.on_probe_w;
    out.time_s.push_back(1e-9 * static_cast<double>(r.time_ns - log->ticks.front().time_ns));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      out.moved_m[i].push_back(moved[axis]);
      out.hand_m[i].push_back(hand[axis]);
      out.force_n[i].push_back(w.force[axis]);
    }
    out.along_m.push_back(start_m + glm::dot(moved, axes.along));
    out.wind_up_m.push_back(glm::dot(hand - moved, axes.along));
    out.along_n.push_back(-glm::dot(w.force, axes.along));
    // The wrench about the point of the mid plane on the gear's crown: what is left of the torque about x is the
    // normal force times its distance.
    const wrench about_crown = transport(w, r.T_wa.position, -models::gear_radius_m * axes.into);
    const double normal_n = -glm::dot(w.force, axes.into);
    out.pressure_m.push_back(normal_n > 0.0 ? about_crown.torque.x / normal_n : 0.0);
  }
  return out;
}

ride_figures figures_of(const ride& r, const ride_settings& with) {
  const auto from = static_cast<std::size_t>(std::lower_bound(r.time_s.begin(), r.time_s.end(), with.judged_from_s) -
                                             r.time_s.begin());
  const std::size_t n = r.time_s.size();
  const double slow_m_per_s = 0.2 * with.drive_m_per_s;
  const std::vector<double>& way = r.along_m;

  // What is slow again in the same notch, after it overshot or crept on, belongs to the same rest.
  struct rest {
    double way_m = 0.0, ticks = 0.0, sum_z_m = 0.0;
  };
  std::vector<rest> rests;
  double across = 0.0, largest = 0.0;
  std::size_t slow = 0;
  ride_figures out;
  for (std::size_t i = from; i + 1 < n; ++i) {
    across = std::max(across, std::fabs(r.force_n[0][i]));
    largest = std::max(largest, std::hypot(r.force_n[0][i], r.force_n[1][i], r.force_n[2][i]));
    out.pressure_m = std::max(out.pressure_m, std::fabs(r.pressure_m[i]));
    if (std::fabs((way[i + 1] - way[i - 1]) / (r.time_s[i + 1] - r.time_s[i - 1])) >= slow_m_per_s) continue;
    ++slow;
    if (rests.empty() || way[i] - rests.back().way_m > 0.25 * models::ridge_wavelength_m) rests.push_back({way[i]});
    rests.back().ticks += 1.0;
    rests.back().sum_z_m += r.moved_m[2][i];
  }
  const double tick_s = (r.time_s.back() - r.time_s[from]) / static_cast<double>(n - 1 - from);
  for (const rest& at : rests) {
    if (at.ticks * tick_s >= shortest_rest_s) out.rest_z_m.push_back(at.sum_z_m / at.ticks);
  }
  out.across_share = across / largest;
  out.dwell = static_cast<double>(slow) / static_cast<double>(n - from);
  out.wind_up_correlation = correlation(r.along_n, r.wind_up_m, from);
  return out;
}

}  // namespace asperity::experiment
