#include "asperity/drivers/spacemouse/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace asperity {

spacemouse_motion::spacemouse_motion(const spacemouse_motion_settings& settings) noexcept : settings_(sane(settings)) {
  reset();
}

void spacemouse_motion::reset() noexcept {
  T_dh_ = settings_.T_dh_start;
  T_dh_.position = glm::clamp(T_dh_.position, settings_.workspace_low_d, settings_.workspace_high_d);
  velocity_d_ = {};
  wanted_n_ = {};
}

void spacemouse_motion::displace(const std::array<double, 6>& share) noexcept {
  for (std::size_t i = 0; i < 6; ++i) wanted_n_[i] = settings_.gain[i] * beyond_dead_zone(share[i]);
}

bool spacemouse_motion::at_rest() const noexcept {
  return wanted_n_.linear == vec3(0.0) && wanted_n_.angular == vec3(0.0);
}

void spacemouse_motion::advance(std::int64_t step_ns) noexcept {
  const double dt = static_cast<double>(std::clamp<std::int64_t>(step_ns, 0, settings_.longest_step_ns)) * 1e-9;
  velocity_d_ = {};
  if (!(dt > 0.0)) return;
  const vec3 shift_d = settings_.R_dn * wanted_n_.linear;
  const vec3 turn_d = settings_.R_dn * wanted_n_.angular;
  vec3 way;
  vec3 turn;
  if (settings_.control == spacemouse_control::rate) {
    way = (dt * settings_.max_speed_m_per_s) * shift_d;
    turn = (dt * settings_.max_turn_rad_per_s) * turn_d;
  } else {
    const pose& rest = settings_.T_dh_start;
    way = rest.position + settings_.reach_m * shift_d - T_dh_.position;
    const quat wanted = exp_rotation(settings_.reach_rad * turn_d) * rest.rotation;
    turn = log_rotation(wanted * glm::conjugate(T_dh_.rotation));
  }
  way = no_longer_than(way, dt * settings_.max_speed_m_per_s);
  turn = no_longer_than(turn, dt * settings_.max_turn_rad_per_s);
  const vec3 before = T_dh_.position;
  T_dh_.position = glm::clamp(before + way, settings_.workspace_low_d, settings_.workspace_high_d);
  T_dh_.rotation = glm::normalize(exp_rotation(turn) * T_dh_.rotation);
  velocity_d_ = {(T_dh_.position - before) / dt, turn / dt};
}

spacemouse_motion_settings spacemouse_motion::sane(spacemouse_motion_settings c) noexcept {
  for (double* x : {&c.max_speed_m_per_s, &c.max_turn_rad_per_s, &c.reach_m, &c.reach_rad}) {
    *x = *x > 0.0 ? std::min(*x, 1e3) : 0.0;
  }
  c.reach_rad = std::min(c.reach_rad, 3.0);  // below half a turn there is one way back only
  c.dead_zone = c.dead_zone > 0.0 ? std::min(c.dead_zone, 0.99) : 0.0;
  for (double& g : c.gain) g = std::isfinite(g) ? std::clamp(g, -1.0, 1.0) : 0.0;
  if (!is_valid({c.R_dn, vec3(0.0)})) c.R_dn = quat(0.0, 1.0, 0.0, 0.0);
  if (!is_valid(c.T_dh_start)) c.T_dh_start = {};
  for (int i = 0; i < 3; ++i) {
    if (!(c.workspace_low_d[i] <= c.workspace_high_d[i]) || !std::isfinite(c.workspace_low_d[i]) ||
        !std::isfinite(c.workspace_high_d[i])) {
      c.workspace_low_d[i] = c.workspace_high_d[i] = c.T_dh_start.position[i];
    }
  }
  c.longest_step_ns = std::max<std::int64_t>(0, c.longest_step_ns);
  return c;
}

double spacemouse_motion::beyond_dead_zone(double share) const noexcept {
  if (!(std::fabs(share) > settings_.dead_zone)) return 0.0;  // NaN as well
  const double size = (std::min(std::fabs(share), 1.0) - settings_.dead_zone) / (1.0 - settings_.dead_zone);
  return std::copysign(std::max(0.0, size), share);
}

vec3 spacemouse_motion::no_longer_than(const vec3& v, double limit) noexcept {
  const double n = glm::length(v);
  return n > limit ? (limit / n) * v : v;
}

}  // namespace asperity
