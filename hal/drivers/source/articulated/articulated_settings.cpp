#include "asperity/drivers/articulated/articulated_settings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

namespace asperity {

double torque_limit_n_m(const arm_joint& joint, const chain_joint& link) noexcept {
  double limit = joint.drive->facts().peak_torque_n_m;
  if (link.max_torque_n_m > 0.0) limit = std::min(limit, link.max_torque_n_m);
  if (joint.max_torque_n_m > 0.0) limit = std::min(limit, joint.max_torque_n_m);
  return limit;
}

result<void> check(const articulated_settings& c) {
  if (result<void> good = check(c.chain); !good) return good;
  const auto wrong = [](std::string what) { return error{error_code::invalid_argument, std::move(what)}; };
  const std::size_t n = c.chain.joints.size();
  if (c.clock == nullptr) return wrong("the arm has no clock to wait with");
  if (c.joints.size() != n) {
    return wrong("the chain has " + std::to_string(n) + " joints and the arm " + std::to_string(c.joints.size()) +
                 " drives; there has to be one for each");
  }
  for (std::size_t b = 0; b < c.buses.size(); ++b) {
    if (c.buses[b].bus == nullptr) return wrong("bus " + std::to_string(b + 1) + " of the arm is missing");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const arm_joint& j = c.joints[i];
    const std::string name = "joint " + std::to_string(i + 1) + " of the arm ";
    if (j.drive == nullptr) return wrong(name + "has no drive");
    if (j.bus >= c.buses.size()) return wrong(name + "is on a bus that is not there");
    const double limit = torque_limit_n_m(j, c.chain.joints[i]);
    if (!(limit > 0.0) || !std::isfinite(limit)) {
      return wrong(name + "has no torque limit above zero: state the drive's rated and peak torque");
    }
    if (!(j.max_speed_rad_per_s > 0.0)) return wrong(name + "has no speed limit above zero");
    for (std::size_t k = 0; k < i; ++k) {
      if (c.joints[k].drive == j.drive) return wrong(name + "has the same drive as another");
    }
  }
  if (!(c.period_ns > 0) || !(c.reading_limit_ns > 0) || !(c.rise_time_s > 0.0)) {
    return wrong("the arm's period, reading limit and rise time have to be above zero");
  }
  const soft_stop& s = c.stop;
  if (!(s.zone_rad >= 0.0) || !(s.stiffness_n_m_per_rad >= 0.0) || !(s.damping_n_m_s_per_rad >= 0.0) ||
      !(s.overrun_rad >= 0.0)) {
    return wrong("the arm's soft stop has a negative number");
  }
  return {};
}

device_capabilities capabilities_of(const articulated_settings& c) noexcept {
  const std::size_t n = c.chain.joints.size();
  const chain_bounds bounds = bounds_of(c.chain);
  device_capabilities out;
  out.name = c.name;
  out.maturity = c.maturity;
  out.sensed = all_axes;
  // With fewer joints than six some wrenches cannot be put out, in no fixed axes of the base.
  out.actuated = n >= 6 ? all_axes : translation_axes;

  double force = 1e6;
  double torque = 1e6;
  double continuous_force = 1e6;
  double continuous_torque = 1e6;
  joint_vector reflected{};
  out.device_side_watchdog = true;
  for (std::size_t i = 0; i < n; ++i) {
    const arm_joint& j = c.joints[i];
    const double limit = torque_limit_n_m(j, c.chain.joints[i]);
    const double held = j.continuous_torque_n_m > 0.0 ? std::min(j.continuous_torque_n_m, limit) : limit / 3.0;
    const double weight = c.gravity_compensation ? bounds.weight_n_m[i] : 0.0;
    const double room = 0.5 * std::max(0.0, limit - weight);
    const double held_room = 0.5 * std::max(0.0, held - weight);
    if (bounds.lever_m[i] > 0.0) {
      force = std::min(force, room / bounds.lever_m[i]);
      continuous_force = std::min(continuous_force, held_room / bounds.lever_m[i]);
    }
    torque = std::min(torque, room);
    continuous_torque = std::min(continuous_torque, held_room);
    reflected[i] = j.reflected_inertia_kg_m2;
    const drive_facts& facts = j.drive->facts();
    out.position_resolution_m += facts.position_resolution_rad * bounds.lever_m[i];
    out.rotation_resolution_rad += facts.position_resolution_rad;
    out.device_side_watchdog = out.device_side_watchdog && facts.drive_side_watchdog;
  }
  out.peak_force_n = c.peak_force_n > 0.0 ? c.peak_force_n : force;
  out.peak_torque_n_m = c.peak_torque_n_m > 0.0 ? c.peak_torque_n_m : torque;
  // A peak that was stated for a part of the workspace has the continuous share that the bound has.
  const auto share = [](double held, double peak) { return peak > 0.0 ? held / peak : 1.0 / 3.0; };
  out.continuous_force_n = out.peak_force_n * share(continuous_force, force);
  out.continuous_torque_n_m = out.peak_torque_n_m * share(continuous_torque, torque);
  out.force_slew_n_per_s = out.peak_force_n / c.rise_time_s;
  out.torque_slew_n_m_per_s = out.peak_torque_n_m / c.rise_time_s;

  const apparent_inertia felt = felt_at_handle(c.chain, forward(c.chain, c.rest_rad), reflected);
  out.moving_mass_kg = c.moving_mass_kg > 0.0 ? c.moving_mass_kg : felt.mass_kg;
  out.moving_inertia_kg_m2 = c.moving_inertia_kg_m2 > 0.0 ? c.moving_inertia_kg_m2 : felt.inertia_kg_m2;

  const vec3 first = c.chain.joints[0].T_parent.position;
  const bool stated = c.workspace_low_d != c.workspace_high_d;
  out.workspace_low_d = stated ? c.workspace_low_d : first - vec3(bounds.reach_m);
  out.workspace_high_d = stated ? c.workspace_high_d : first + vec3(bounds.reach_m);
  out.max_stiffness_n_per_m = c.max_stiffness_n_per_m;
  out.max_stiffness_n_m_per_rad = c.max_stiffness_n_m_per_rad;
  out.max_stiffness_rate_hz = c.max_stiffness_rate_hz;
  out.nominal_rate_hz = 1e9 / static_cast<double>(c.period_ns);
  out.minimum_rate_hz = 1e9 / static_cast<double>(c.reading_limit_ns);
  out.worst_latency_ns = 2 * c.period_ns;
  return out;
}

}  // namespace asperity
