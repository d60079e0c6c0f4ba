#include "turned_block.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "trial.hpp"

namespace asperity::experiment {
namespace {

using std::numbers::pi;

constexpr double amplitude_m = models::ridge_amplitude_m;
constexpr double per_m = 2.0 * pi / models::ridge_wavelength_m;

// The hand takes the block down, waits until it lies still, and turns it at one speed.
constexpr double turn_begins_s = 0.5;
constexpr double rest_begins_s = 0.4;

constexpr double step_rad = 0.0025;  // between angles of the brute force

// 0, reach, -reach, 0 in straight lines. @param travelled  way that the hand has turned, rad
double there_and_back(double travelled, double reach) {
  if (travelled < reach) return travelled;
  if (travelled < 3.0 * reach) return 2.0 * reach - travelled;
  return std::min(0.0, travelled - 4.0 * reach);
}

// Peak to valley of the sine whose height has the variance of the block's whole surface, its level sides included: what
// the library measures softness by.
double peak_to_valley_m() {
  const double lx = 2.0 * block_half_m[0], ly = 2.0 * block_half_m[1], lz = 2.0 * block_half_m[2];
  constexpr int nx = 400, ny = 380;
  double height = 0.0, square = 0.0;
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      const ridge_heights h = ridges_at(((i + 0.5) / nx - 0.5) * lx, ((j + 0.5) / ny - 0.5) * ly);
      height += h.top_m - h.bottom_m;
      square += h.top_m * h.top_m + h.bottom_m * h.bottom_m;
    }
  }
  const double share = lx * ly / (nx * ny) / (2.0 * (lx * ly + lx * lz + ly * lz));
  return 2.0 * std::numbers::sqrt2 * std::sqrt(share * square - share * height * share * height);
}

double turn_about_z(const quat& r) { return 2.0 * std::atan2(r.z, r.w); }

}  // namespace

pose upper_block() { return {quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 2.0 * block_half_m[2])}; }

result<scene> block_on_block(workbench& bench) {
  result<model_ptr> block = striped_block(bench);
  if (!block) return block.error();
  return scene{*block, {*block}};
}

result<std::vector<turned_sample>> turn_block(any_renderer feel, const turning& how) {
  trial t;
  t.T_wa_start = upper_block();
  t.T_wa_start.position.z += 0.1e-3;
  t.T_wb = {pose{}};
  t.seconds = turn_begins_s + how.parts * how.reach_rad / how.speed_rad_per_s;
  t.contact_period_ns = how.contact_period_ns;
  // Geometry is asked for here, not what delays do: that is the experiment on stability. A tool of 50 g, in proportion
  // to the block.
  t.contact_one_period_late = false;
  t.control.probe = {.mass_kg = 0.05, .inertia_kg_m2 = mat3(2e-5)};
  // The hand guides the block: it holds it over its place and turns it, and leaves its height to the push.
  t.grip = {.rigid = false,
            .stiffness_n_per_m = {3000.0, 3000.0, 0.0},
            .damping_n_s_per_m = {20.0, 20.0, 1.5},
            .stiffness_n_m_per_rad = vec3(20.0),
            .damping_n_m_s_per_rad = vec3(0.1),
            .mass_kg = 0.03,
            .inertia_kg_m2 = 5e-5};
  const pose start = t.T_wa_start;
  const auto hand_angle = [how](double t_s) {
    return there_and_back(how.speed_rad_per_s * std::max(0.0, t_s - turn_begins_s), how.reach_rad);
  };
  t.script = [start, hand_angle](double t_s) {
    hand_wish wish;
    wish.T_dh = {exp_rotation(vec3(0.0, 0.0, hand_angle(t_s))), start.position};
    wish.velocity_d.angular.z = (hand_angle(t_s + 1e-6) - hand_angle(t_s)) / 1e-6;
    wish.push_d.force.z = -turned_block_press_n * std::clamp(t_s / 0.1, 0.0, 1.0);
    return wish;
  };
  const result<trial_log> log = run_trial(std::move(feel), std::move(t));
  if (!log) return log.error();

  std::vector<turned_sample> out;
  double rest_z_m = 0.0;
  std::size_t at_rest = 0;
  for (const session_record& r : log->ticks) {
    const double now_s = 1e-9 * static_cast<double>(r.time_ns);
    if (now_s < rest_begins_s) continue;
    if (now_s < turn_begins_s) {
      rest_z_m += r.T_wa.position.z;
      ++at_rest;
      continue;
    }
    out.push_back({now_s, hand_angle(now_s), turn_about_z(r.T_wa.rotation), r.T_wa.position.z, r.on_probe_w.force.z,
                   r.on_probe_w.torque.z});
  }
  for (turned_sample& s : out) s.rise_m -= rest_z_m / static_cast<double>(at_rest);
  return out;
}

double saturation_angle_rad() noexcept { return 0.5 * models::ridge_wavelength_m / ridge_half_length_m; }

double torque_arm_m(double angle_rad) noexcept {
  if (std::abs(angle_rad) >= saturation_angle_rad()) return 0.0;
  const double phase = 0.5 * per_m * ridge_half_length_m * angle_rad;
  const double arm = amplitude_m * per_m * ridge_half_length_m * std::cos(phase);
  return angle_rad > 0.0 ? -arm : (angle_rad < 0.0 ? arm : 0.0);
}

depth_kind depth_of(const command::render_options& options) {
  if (command::formulation_name(options) == "least-motion") return depth_kind::way_out;
  return command::gradient_name(options) == "central" ? depth_kind::largest : depth_kind::soft;
}

rise_by_brute_force::rise_by_brute_force(double reach_rad, depth_kind kind) {
  const bool hard = kind != depth_kind::soft;
  // The largest overlap of samples 0.1 mm apart is 0.3 % of the amplitude too small at most; a mean needs fewer.
  const double step_m = hard ? 1e-4 : 2e-4;
  const double tau_m = 0.02 * peak_to_valley_m();
  const auto last = static_cast<int>(std::ceil(reach_rad / step_rad)) + 1;
  const auto nx = static_cast<int>(std::lround(block_half_m[0] / step_m));
  const auto ny = static_cast<int>(std::lround(block_half_m[1] / step_m));
  for (int k = 0; k <= last; ++k) {
    const double c = std::cos(k * step_rad), s = std::sin(k * step_rad);
    double largest = 0.0, count = 0.0, sum = 0.0;
    // A turn by half a circle about z takes both blocks into themselves: half of the samples will do.
    for (int i = 0; i < nx; ++i) {
      for (int j = -ny; j < ny; ++j) {
        const double x = (i + 0.5) * step_m, y = (j + 0.5) * step_m;
        const double ax = c * x + s * y, ay = c * y - s * x;
        if (std::abs(ax) > block_half_m[0] || std::abs(ay) > block_half_m[1]) continue;
        const double overlap_m = ridges_at(x, y).top_m - ridges_at(ax, ay).bottom_m;
        largest = std::max(largest, overlap_m);
        if (hard) continue;
        count += 1.0;
        sum += std::exp(overlap_m / tau_m);
      }
    }
    rise_m_.push_back(hard ? largest : tau_m * std::log(sum / count));
  }
}

double rise_by_brute_force::operator()(double angle_rad) const noexcept {
  const double at = std::abs(angle_rad) / step_rad;
  const auto i = std::min(static_cast<std::size_t>(at), rise_m_.size() - 2);
  const double f = at - static_cast<double>(i);
  return (1.0 - f) * rise_m_[i] + f * rise_m_[i + 1];
}

}  // namespace asperity::experiment
