#include "stability_hold.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "asperity/device/simulated/simulated_settings.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "asperity/window/gradient_penalty.hpp"
#include "lattice_solid.hpp"

namespace asperity::experiment {
namespace {

constexpr double usual_stiffness_n_per_m = gradient_penalty_settings{}.stiffness_n_per_m;
static_assert(usual_stiffness_n_per_m == least_motion_settings{}.stiffness_n_per_m);

/// Renders with another renderer and changes what it finds.
class changed_renderer {
 public:
  changed_renderer(std::shared_ptr<any_renderer> inner, double factor, contact_line line,
                   std::shared_ptr<bool> one_contact)
      : inner_(std::move(inner)), one_contact_(std::move(one_contact)), factor_(factor), line_(line) {}

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const status s = inner_->step(at, out);
    if (s != status::ok && s != status::capacity_reached) return s;
    if (line_ == contact_line::held) out.force.stiffness = {};
    if (line_ == contact_line::linearised) leave_out_curvature(out);
    out.force.on_probe_w = factor_ * out.force.on_probe_w;
    out.force.stiffness = factor_ * out.force.stiffness;
    return s;
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return inner_->scene(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return inner_->memory_bytes(); }

 private:
  void leave_out_curvature(tick& out) const noexcept {
    const bool touches = out.force.on_probe_w.force != vec3(0.0);
    if (out.depths.size() > 1) *one_contact_ = false;
    out.force.stiffness = {};
    if (touches && !out.depths.empty()) {
      add_outer(out.force.stiffness, -usual_stiffness_n_per_m, out.depths.front().gradient);
    }
  }

  std::shared_ptr<any_renderer> inner_;
  std::shared_ptr<bool> one_contact_;
  double factor_;
  contact_line line_;
};

// A pad with the ridges of the benchmark's block, but only two and a half of them: one contact costs a seventh of the
// block's at the same pitch of samples, and hundreds of sessions are wanted. It is high so that it may dive deep before
// the finder gives up, at a tenth of its diagonal.
constexpr double pad_m = 10e-3, pad_height_m = 20e-3;
constexpr std::uint32_t pad_grid = 24;

triangle_mesh make_pad(double amplitude_m) {
  constexpr double half = 0.5 * pad_m, half_z = 0.5 * pad_height_m, fade = models::ridge_fade_m;
  models::lattice_solid solid;
  solid.axes[0] = {{-half, -half + fade, half - fade, half}, {4, 8, 4}};
  solid.axes[1] = {{-half, half}, {80}};
  solid.axes[2] = {{-half_z, half_z}, {8}};
  solid.filled = [](const vec3&) { return true; };
  return models::surface_of(solid, [amplitude_m](const vec3& p) {
    if (std::abs(p.z) < half_z) return p;
    const double share = smoothstep((half - std::abs(p.x)) / fade);
    const double wave = std::cos(2.0 * std::numbers::pi / models::ridge_wavelength_m * p.y);
    return p + vec3(0.0, 0.0, share * amplitude_m * wave);
  });
}

triangle_mesh make_coarse_pad() {
  constexpr double half = 0.5 * pad_m, half_z = 0.5 * pad_height_m;
  models::lattice_solid solid;
  solid.axes = {{{{-half, half}, {1}}, {{-half, half}, {1}}, {{-half_z, half_z}, {1}}}};
  solid.filled = [](const vec3&) { return true; };
  return models::surface_of(solid, [](const vec3& p) { return p; });
}

// The pads' ridges fit into each other where one lies right above the other.
trial held_pad(const notch& where, const holding& how) {
  const double crest_to_crest_m = where.is_flat() ? 0.0 : 2.0 * models::ridge_amplitude_m;
  const double rise_m = crest_to_crest_m * std::sin(std::numbers::pi * how.beside_m / models::ridge_wavelength_m);
  trial t;
  t.T_wa_start = {quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, how.beside_m, pad_height_m + rise_m + how.drop_m)};
  t.T_wb = {pose{}};
  t.script = [start = t.T_wa_start, press_n = how.press_n](double t_s) {
    hand_wish wish;
    wish.T_dh.position = start.position;
    wish.push_d.force.z = -press_n * std::clamp(t_s / 0.2, 0.0, 1.0);
    return wish;
  };
  t.grip = {.rigid = false,
            .stiffness_n_per_m = vec3(100.0, 100.0, 0.0),
            .damping_n_s_per_m = vec3(5.0),
            .stiffness_n_m_per_rad = vec3(2.0),
            .damping_n_m_s_per_rad = vec3(0.02)};
  const device_capabilities real = simulated_capabilities();
  t.control.limits = {.peak_force_n = real.peak_force_n,
                      .continuous_force_n = real.peak_force_n,
                      .force_slew_n_per_s = real.force_slew_n_per_s,
                      .peak_torque_n_m = real.peak_torque_n_m,
                      .continuous_torque_n_m = real.peak_torque_n_m,
                      .torque_slew_n_m_per_s = real.torque_slew_n_m_per_s};
  t.control.guard.enabled = how.guard;
  t.gate_may_shut = true;
  t.contact_period_ns = how.contact_period_ns;
  t.contact_one_period_late = how.late;
  t.seconds = how.settle_s + how.hold_s;
  return t;
}

// Root mean square of what changes faster than 20 Hz.
double fast_motion(const std::vector<vec3>& velocity, double h_s) {
  const double keep = 1.0 / (1.0 + 2.0 * std::numbers::pi * 20.0 * h_s);
  vec3 high(0.0);
  double sum = 0.0;
  for (std::size_t i = 1; i < velocity.size(); ++i) {
    high = keep * (high + velocity[i] - velocity[i - 1]);
    sum += glm::dot(high, high);
  }
  return velocity.size() > 1 ? std::sqrt(sum / static_cast<double>(velocity.size() - 1)) : 0.0;
}

}  // namespace

result<notch> notch::make(workbench& bench, const variant& kind, bool flat) {
  bake::bake_settings options;
  options.coarse = make_coarse_pad();
  options.texture_size = 256;
  const result<model_ptr> pad =
      flat ? bench.models().baked(
                 "flat_pad_10x10x20mm", [] { return make_pad(0.0); }, std::move(options))
           : bench.models().baked(
                 "ridged_pad_10x10x20mm", [] { return make_pad(models::ridge_amplitude_m); }, std::move(options));
  if (!pad) return pad.error();
  variant on_pad = kind;
  if (kind.options.contacts == "window") on_pad.options.grid = pad_grid;
  result<any_renderer> feel = bench.make_renderer({*pad, {*pad}}, on_pad);
  if (!feel) return feel.error();
  notch out;
  out.flat_ = flat;
  out.inner_ = std::make_shared<any_renderer>(std::move(feel).value());
  out.one_contact_ = std::make_shared<bool>(true);
  return out;
}

any_renderer notch::with(double stiffness_n_per_m, contact_line line) const {
  // Far away every contact of the last session is forgotten.
  tick found;
  const pose nowhere{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0)};
  const std::vector<pose> T_wb(1);
  static_cast<void>(inner_->step({nowhere, T_wb}, found));
  return any_renderer(changed_renderer(inner_, stiffness_n_per_m / usual_stiffness_n_per_m, line, one_contact_));
}

double guard_bound_j(double speed_m_per_s, double speed_rad_per_s) noexcept {
  const device_capabilities real = simulated_capabilities();
  constexpr double h_s = 1e-9 * static_cast<double>(device_period_ns);
  const auto beyond = [](double peak, double slew, double speed) { return 0.5 * peak * speed * (peak / slew + h_s); };
  return guard_settings{}.hard_limit_j + beyond(real.peak_force_n, real.force_slew_n_per_s, speed_m_per_s) +
         beyond(real.peak_torque_n_m, real.torque_slew_n_m_per_s, speed_rad_per_s);
}

result<held_still> hold_still(const notch& where, const holding& how) {
  result<trial_log> log = run_trial(where.with(how.stiffness_n_per_m, how.line), held_pad(where, how));
  if (!log) return log.error();
  held_still out;
  out.shut = log->ended.fault != gate_fault::none;
  constexpr double h_s = 1e-9 * static_cast<double>(device_period_ns);
  std::vector<vec3> velocity;
  double fastest = 0.0, fastest_turn = 0.0, before_j = 0.0;
  std::size_t acted = 0;
  const std::vector<session_record>& ticks = log->ticks;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const session_record& r = ticks[i];
    const double t_s = 1e-9 * static_cast<double>(r.time_ns - ticks.front().time_ns);
    out.time_s.push_back(t_s);
    out.sideways_m.push_back(r.T_dh.position.y);
    out.energy_j.push_back(r.delivered_j);
    out.surplus_j = std::max(out.surplus_j, r.surplus_j);
    acted += r.guard_alpha_per_s > 0.0 || r.guard_scale < 1.0 ? 1U : 0U;
    if (t_s < how.settle_s) before_j = r.delivered_j;
    if (i == 0) continue;
    const session_record& last = ticks[i - 1];
    const vec3 v = (r.T_dh.position - last.T_dh.position) / h_s;
    fastest = std::max(fastest, glm::length(v));
    const vec3 turn = log_rotation(r.T_dh.rotation * glm::conjugate(last.T_dh.rotation)) / h_s;
    fastest_turn = std::max(fastest_turn, glm::length(turn));
    if (t_s >= how.settle_s) velocity.push_back(v);
  }
  if (!ticks.empty()) {
    out.touches = ticks.back().max_depth_m > 0.0;
    out.given_j = ticks.back().delivered_j - before_j;
    out.guard_share = static_cast<double>(acted) / static_cast<double>(ticks.size());
  }
  out.vibration_m_per_s = fast_motion(velocity, h_s);
  out.bound_j = guard_bound_j(fastest, fastest_turn);
  return out;
}

}  // namespace asperity::experiment
