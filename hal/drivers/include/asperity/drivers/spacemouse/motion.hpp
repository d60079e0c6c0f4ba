// From the displacement of a cap that springs back to a pose that a session can use.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// What a displacement of the cap means.
enum class spacemouse_control : std::uint8_t {
  rate,      ///< a speed: the pose moves on while the cap is pushed and stays where it is when it is let go
  position,  ///< a place: the pose follows the cap, and returns with it
};

/// How the cap moves the pose.
///
/// Device axes are x right, y towards the person, z down, for shifts and for turns; turns are right handed about them.
/// The base frame d is x right, y away from the person, z up: both are right handed, half a turn about x apart, so one
/// rotation maps shifts and turns alike. This follows published recordings and has not been seen on a device.
struct spacemouse_motion_settings {
  spacemouse_control control = spacemouse_control::rate;
  double max_speed_m_per_s = 0.1;   ///< rate: at full displacement; position: the fastest that the pose follows
  double max_turn_rad_per_s = 1.0;  ///< likewise
  double reach_m = 0.05;            ///< position: at full displacement
  double reach_rad = 0.5;           ///< position: at full displacement
  double dead_zone = 0.04;          ///< share of full displacement that counts as none, 0 to below 1; what is
                                    ///< beyond it begins at zero, without a step
  std::array<double, 6> gain{1, 1, 1, 1, 1, 1};  ///< per device axis, -1 to 1: below 0 turned round, 0 off
  quat R_dn{0.0, 1.0, 0.0, 0.0};                 ///< device axes n in the base frame d; GLM's order w x y z
  vec3 workspace_low_d{-0.1, -0.1, -0.1};        ///< the pose's origin stays in this box
  vec3 workspace_high_d{0.1, 0.1, 0.1};
  pose T_dh_start{};  ///< where the handle is when the device is opened; position: where it rests
  std::int64_t longest_step_ns = 20'000'000;  ///< a later tick moves the pose by this much time only
};

/// Integrates or follows. Whatever comes in, the pose is finite, of unit length and in its box, and moves no faster
/// than the configuration says.
/// @rt safe after construction
class spacemouse_motion {
 public:
  explicit spacemouse_motion(const spacemouse_motion_settings& settings = {}) noexcept : settings_(sane(settings)) {
    reset();
  }

  /// Back to the start, at rest.
  void reset() noexcept {
    T_dh_ = settings_.T_dh_start;
    T_dh_.position = glm::clamp(T_dh_.position, settings_.workspace_low_d, settings_.workspace_high_d);
    velocity_d_ = {};
    wanted_n_ = {};
  }

  /// Where the cap is, as shares of full displacement in device axes. More than one counts as one, NaN as none.
  void displace(const std::array<double, 6>& share) noexcept {
    for (std::size_t i = 0; i < 6; ++i) wanted_n_[i] = settings_.gain[i] * beyond_dead_zone(share[i]);
  }

  /// Whether the cap asks for nothing.
  [[nodiscard]] bool at_rest() const noexcept {
    return wanted_n_.linear == vec3(0.0) && wanted_n_.angular == vec3(0.0);
  }

  /// The time that has gone by. Less than none counts as none.
  void advance(std::int64_t step_ns) noexcept {
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

  [[nodiscard]] const pose& T_dh() const noexcept { return T_dh_; }
  /// Over the last step.
  [[nodiscard]] const twist& velocity_d() const noexcept { return velocity_d_; }
  [[nodiscard]] const spacemouse_motion_settings& settings() const noexcept { return settings_; }

 private:
  // A number that makes no sense becomes the one that moves nothing.
  [[nodiscard]] static spacemouse_motion_settings sane(spacemouse_motion_settings c) noexcept {
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

  [[nodiscard]] double beyond_dead_zone(double share) const noexcept {
    if (!(std::fabs(share) > settings_.dead_zone)) return 0.0;  // NaN as well
    const double size = (std::min(std::fabs(share), 1.0) - settings_.dead_zone) / (1.0 - settings_.dead_zone);
    return std::copysign(std::max(0.0, size), share);
  }

  [[nodiscard]] static vec3 no_longer_than(const vec3& v, double limit) noexcept {
    const double n = glm::length(v);
    return n > limit ? (limit / n) * v : v;
  }

  spacemouse_motion_settings settings_;
  pose T_dh_{};
  twist velocity_d_{};
  vec6 wanted_n_{};
};

}  // namespace asperity
