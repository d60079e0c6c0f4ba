#include "stability_coupling.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "stability_hold.hpp"

namespace asperity::experiment {
namespace {

constexpr double period_s = 1e-9 * static_cast<double>(device_period_ns);
constexpr double softest_coupling_n_per_m = 100.0, stiffest_coupling_n_per_m = 2e5;

trial kicked_hand(double stiffness_n_per_m, double damping_n_s_per_m) {
  trial t;
  t.T_wa_start = {quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.2)};  // far from the other block
  t.T_wb = {pose{}};
  t.script = [start = t.T_wa_start](double t_s) {
    hand_wish wish;
    wish.T_dh.position = start.position;
    if (t_s >= 0.02 && t_s < 0.03) wish.push_d.force.z = 1.0;
    return wish;
  };
  t.grip = {.rigid = false,
            .damping_n_s_per_m = vec3(kicked_damping_n_s_per_m),
            .damping_n_m_s_per_rad = vec3(0.05),
            .mass_kg = kicked_mass_kg};
  t.control.guard.enabled = false;
  t.control.probe = {.mass_kg = 1e6, .inertia_kg_m2 = mat3(1e6)};
  t.control.coupling.stiffness_n_per_m = stiffness_n_per_m;
  t.control.coupling.damping_n_s_per_m = damping_n_s_per_m;
  t.gate_may_shut = true;
  t.contact_period_ns = 20'000'000;
  t.seconds = 1.0;
  return t;
}

// Energy of the handle's motion in a part of a session, up to a factor.
double hand_unrest(const trial_log& log, double from_s, double to_s) {
  double sum = 0.0;
  for (std::size_t i = 1; i < log.ticks.size(); ++i) {
    const double t_s = 1e-9 * static_cast<double>(log.ticks[i].time_ns - log.ticks.front().time_ns);
    if (t_s < from_s || t_s >= to_s) continue;
    const vec3 step = log.ticks[i].T_dh.position - log.ticks[i - 1].T_dh.position;
    sum += glm::dot(step, step);
  }
  return sum;
}

result<bool> comes_to_rest(const notch& where, double stiffness_n_per_m, double damping_n_s_per_m) {
  constexpr double usual_contact_n_per_m = 2000.0;
  const result<trial_log> log = run_trial(where.with(usual_contact_n_per_m, contact_line::curved),
                                          kicked_hand(stiffness_n_per_m, damping_n_s_per_m));
  if (!log) return log.error();
  if (log->ended.fault != gate_fault::none) return false;
  return hand_unrest(*log, 0.75, 1.0) < hand_unrest(*log, 0.05, 0.3);
}

// The largest stiffness at which `holds` is true, to `steps` halvings of the range.
result<double> largest_stable(const std::function<result<bool>(double)>& holds, int steps) {
  double low = softest_coupling_n_per_m, high = stiffest_coupling_n_per_m;
  for (int i = 0; i < steps; ++i) {
    const double middle = std::sqrt(low * high);
    const result<bool> held = holds(middle);
    if (!held) return held.error();
    (*held ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

// Whether all poles lie inside the unit circle (Jury). Position x and velocity v of a mass m with damping b under a
// force f = -K x - B (x - x_before) / T that is held for T:
//   x' = x + p v + (T - p) f / b,   v' = e v + (1 - e) f / b,   e = exp(-b T / m),   p = (1 - e) m / b.
bool poles_are_inside(double K, double B) {
  const double b = kicked_damping_n_s_per_m, m = kicked_mass_kg, T = period_s;
  const double e = std::exp(-b * T / m), p = (1.0 - e) * m / b;
  const double f_x = -K - B / T, f_before = B / T;
  const double x_f = (T - p) / b, v_f = (1.0 - e) / b;
  const double c2 = -(1.0 + x_f * f_x + e);
  const double c1 = (1.0 + x_f * f_x) * e - p * v_f * f_x - x_f * f_before;
  const double c0 = -(p * v_f * f_before - x_f * f_before * e);
  return 1.0 + c2 + c1 + c0 > 0.0 && 1.0 - c2 + c1 - c0 > 0.0 && std::fabs(c0) < 1.0 &&
         std::fabs(c0 * c0 - 1.0) > std::fabs(c0 * c2 - c1);
}

}  // namespace

result<std::vector<coupling_limit>> coupling_limits(workbench& bench, const std::vector<double>& dampings_n_s_per_m) {
  const result<notch> where = notch::make(bench, window_soft(), true);
  if (!where) return where.error();
  std::vector<coupling_limit> out;
  for (const double B : dampings_n_s_per_m) {
    if (const result<void> on = bench.go_on(); !on) return on.error();
    const result<double> measured =
        largest_stable([&](double K) { return comes_to_rest(*where, K, B); }, bench.brief() ? 10 : 13);
    if (!measured) return measured.error();
    const result<double> theory = largest_stable([&](double K) -> result<bool> { return poles_are_inside(K, B); }, 40);
    if (!theory) return theory.error();
    out.push_back({B, *measured, *theory, std::max(0.0, 2.0 * (kicked_damping_n_s_per_m - B) / period_s)});
  }
  return out;
}

}  // namespace asperity::experiment
