#include "asperity/device/simulated/motion_script.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace asperity {

motion_script::motion_script(const motion_settings& settings, std::uint64_t seed) : settings_(settings) {
  std::mt19937_64 bits(seed);
  for (wave& w : waves_) {
    // Rates around the typical one, without a common period within a session.
    w.rate_rad_per_s = two_pi * settings.frequency_hz * (0.5 + unit(bits));
    w.phase_rad = two_pi * unit(bits);
  }
}

hand_target motion_script::at(double t_s) const noexcept {
  return settings_.kind == motion_kind::free ? wander(t_s) : approach_and_move(t_s);
}

double motion_script::unit(std::mt19937_64& bits) noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

hand_target motion_script::approach_and_move(double t_s) const noexcept {
  const double x = t_s / settings_.approach_s;
  hand_target out;
  out.T_dh = settings_.T_dh;
  out.T_dh.position += settings_.depth_m * smoothstep(x) * settings_.direction_d;
  out.velocity_d.linear = settings_.depth_m * smoothstep_slope(x) / settings_.approach_s * settings_.direction_d;

  const double since = t_s - settings_.approach_s;
  if (settings_.kind == motion_kind::press || since <= 0.0) return out;
  const double grown = smoothstep(since / ramp_s);
  if (settings_.kind == motion_kind::tap) {
    add_taps(since, grown, out);
    return out;
  }
  const double w = two_pi * settings_.frequency_hz;
  const double sway = grown * std::sin(w * since);
  const double rate = grown * w * std::cos(w * since) + smoothstep_slope(since / ramp_s) / ramp_s * std::sin(w * since);
  if (settings_.kind == motion_kind::scrub) {
    out.T_dh.position += settings_.amplitude_m * sway * settings_.sideways_d;
    out.velocity_d.linear += settings_.amplitude_m * rate * settings_.sideways_d;
  } else {
    out.T_dh.rotation = exp_rotation(settings_.amplitude_rad * sway * settings_.direction_d) * settings_.T_dh.rotation;
    out.velocity_d.angular = settings_.amplitude_rad * rate * settings_.direction_d;
  }
  return out;
}

void motion_script::add_taps(double since, double grown, hand_target& out) const noexcept {
  constexpr double uneven_rad = 0.8;
  const wave& sway = waves_[0];
  const double slow = 0.5 * sway.rate_rad_per_s * since + sway.phase_rad;
  const double beat = two_pi * settings_.frequency_hz * since + uneven_rad * std::sin(slow);
  const double beat_rate = two_pi * settings_.frequency_hz + uneven_rad * 0.5 * sway.rate_rad_per_s * std::cos(slow);
  const double lift = 0.5 * (1.0 - std::cos(beat));
  const double rate = smoothstep_slope(since / ramp_s) / ramp_s * lift + grown * 0.5 * std::sin(beat) * beat_rate;
  out.T_dh.position -= settings_.amplitude_m * grown * lift * settings_.direction_d;
  out.velocity_d.linear -= settings_.amplitude_m * rate * settings_.direction_d;
}

hand_target motion_script::wander(double t_s) const noexcept {
  const double grown = smoothstep(t_s / settings_.approach_s);
  const double growth = smoothstep_slope(t_s / settings_.approach_s) / settings_.approach_s;
  vec6 way;
  vec6 rate;
  for (std::size_t i = 0; i < 6; ++i) {
    const double amplitude = i < 3 ? settings_.amplitude_m : settings_.amplitude_rad;
    const double angle = waves_[i].rate_rad_per_s * t_s + waves_[i].phase_rad;
    way[i] = amplitude * grown * std::sin(angle);
    rate[i] = amplitude * (growth * std::sin(angle) + grown * waves_[i].rate_rad_per_s * std::cos(angle));
  }
  const pose T{exp_rotation(way.angular) * settings_.T_dh.rotation, settings_.T_dh.position + way.linear};
  return {T, {rate.linear, angular_velocity(way.angular, rate.angular)}};
}

vec3 motion_script::angular_velocity(const vec3& phi, const vec3& rate) noexcept {
  const double a2 = glm::dot(phi, phi);
  const double a = std::sqrt(a2);
  const double first = a < 1e-3 ? 0.5 - a2 / 24.0 : (1.0 - std::cos(a)) / a2;
  const double second = a < 1e-3 ? 1.0 / 6.0 - a2 / 120.0 : (a - std::sin(a)) / (a2 * a);
  const vec3 turned = glm::cross(phi, rate);
  return rate + first * turned + second * glm::cross(phi, turned);
}

}  // namespace asperity
