// The spring and damper between the device's handle and the probe, and what a first touch adds to them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/device/capabilities.hpp"

namespace asperity {

/// Stiffness and damping of the virtual coupling. A damping left at zero is made critical for the probe's mass.
struct coupling_settings {
  double stiffness_n_per_m = 500.0;
  double stiffness_n_m_per_rad = 3.0;
  double damping_n_s_per_m = 0.0;
  double damping_n_m_s_per_rad = 0.0;
  double max_damping_n_s_per_m = 5.0;       ///< bound of the critical damping; the device's own where strict
  double max_damping_n_m_s_per_rad = 0.05;  ///< passivity is wanted (b_device > Kt T / 2 + Bt)
};

/// The springs of a virtual coupling at one pose of the probe.
struct coupling_pull {
  wrench on_probe_w{};                 ///< about c_A, world axes, without the damper
  double stiffness_n_per_m = 0.0;      ///< 0: not known
  double stiffness_n_m_per_rad = 0.0;  ///< 0: not known
};

/// Isotropic six-dimensional spring and damper.
/// @source science, section 4
class virtual_coupling {
 public:
  /// @param inertia_kg_m2 a typical moment of inertia of the probe
  virtual_coupling(const coupling_settings& c, double mass_kg, double inertia_kg_m2) noexcept
      : kt_(c.stiffness_n_per_m),
        kr_(c.stiffness_n_m_per_rad),
        bt_(c.damping_n_s_per_m > 0.0 ? c.damping_n_s_per_m
                                      : std::min(c.max_damping_n_s_per_m, 2.0 * std::sqrt(kt_ * mass_kg))),
        br_(c.damping_n_m_s_per_rad > 0.0
                ? c.damping_n_m_s_per_rad
                : std::min(c.max_damping_n_m_s_per_rad, 2.0 * std::sqrt(kr_ * inertia_kg_m2))) {}

  /// Wrench on the probe, about its centre of mass, world axes. The device feels the negative.
  /// @param target_T_wc, target_velocity_w where the device wants the probe's centre-of-mass frame
  /// @rt safe
  [[nodiscard]] wrench on_probe(const pose& target_T_wc, const twist& target_velocity_w, const pose& T_wc,
                                const twist& velocity_w) const noexcept {
    const vec3 stretch = target_T_wc.position - T_wc.position;
    const vec3 turn = log_rotation(target_T_wc.rotation * glm::conjugate(T_wc.rotation));
    return {kt_ * stretch + bt_ * (target_velocity_w.linear - velocity_w.linear),
            kr_ * turn + br_ * (target_velocity_w.angular - velocity_w.angular)};
  }

  /// The springs alone.
  /// @rt safe
  [[nodiscard]] coupling_pull pull(const pose& target_T_wc, const pose& T_wc) const noexcept {
    return {on_probe(target_T_wc, {}, T_wc, {}), kt_, kr_};
  }

  /// Energy stored in the two springs, J.
  [[nodiscard]] double stored_j(const pose& target_T_wc, const pose& T_wc) const noexcept {
    const vec3 stretch = target_T_wc.position - T_wc.position;
    const vec3 turn = log_rotation(target_T_wc.rotation * glm::conjugate(T_wc.rotation));
    return 0.5 * kt_ * glm::dot(stretch, stretch) + 0.5 * kr_ * glm::dot(turn, turn);
  }

  [[nodiscard]] double stiffness_n_per_m() const noexcept { return kt_; }
  [[nodiscard]] double stiffness_n_m_per_rad() const noexcept { return kr_; }
  [[nodiscard]] double damping_n_s_per_m() const noexcept { return bt_; }
  [[nodiscard]] double damping_n_m_s_per_rad() const noexcept { return br_; }

 private:
  double kt_;
  double kr_;
  double bt_;
  double br_;
};

/// The coupling for a device at a rate, in the units of a world that a workspace_map scales.
///
/// Support planes are far stiffer than any device, so the coupling is what a hand feels of a hard surface, and it
/// should be as stiff as the device can show. Three things bound it:
/// - A sampled spring is stable on a damped device while K T/2 + B < b (Colgate and Schenkel), so the largest stiffness
///   falls with the rate below the one that it is stated for. It is not raised above that rate: gears, cables and
///   structure then decide.
/// - Half of that stiffness is taken: the other half of b is left for the coupling's damper and for a data sheet that
///   was written for another hand.
/// - The largest force should take a way that a hand can steer in: at least two millimetres of stretch (and 0.05 rad).
/// A stiffness that the device does not state (0) leaves the coupling's default, or less where the largest force would
/// have too short a way.
/// @param scale workspace_map::scale; a device's K and B are K / scale^2 and B / scale^2 in the world, its force F is
///              F / scale
/// @pre rate_hz > 0, scale > 0
[[nodiscard]] inline coupling_settings coupling_for(const device_capabilities& device, double rate_hz,
                                                    double scale = 1.0) noexcept {
  constexpr double share = 0.5;
  constexpr double least_stretch_m = 0.002;
  constexpr double least_turn_rad = 0.05;
  const double slower =
      device.max_stiffness_rate_hz > 0.0 ? std::min(1.0, rate_hz / device.max_stiffness_rate_hz) : 1.0;
  const auto fitting = [&](double stated, double usual, double peak, double least_way) {
    const double stable = stated > 0.0 ? share * slower * stated : usual;
    return peak > 0.0 ? std::min(stable, peak / least_way) : stable;
  };
  coupling_settings out;
  out.max_damping_n_s_per_m /= scale * scale;
  out.stiffness_n_per_m =
      fitting(device.max_stiffness_n_per_m, out.stiffness_n_per_m, device.peak_force_n, least_stretch_m) /
      (scale * scale);
  out.stiffness_n_m_per_rad =
      fitting(device.max_stiffness_n_m_per_rad, out.stiffness_n_m_per_rad, device.peak_torque_n_m, least_turn_rad);
  return out;
}

/// Decaying sinusoid that the hand is given at a first touch: A exp(-t / decay) sin(2 pi f t), against the approach first.
/// A loop whose coupling is softer than a real contact cannot ring as one does; this rings for it. None by default.
struct transient_settings {
  double amplitude_n_s_per_m = 0.0;  ///< A by the handle's speed of approach; 0: none
  double frequency_hz = 150.0;       ///< at most a fifth of the device loop's rate is played
  double decay_s = 0.015;
  double most_force_n = 2.0;  ///< of A
  double quiet_s = 0.05;      ///< a touch after so long without one is a first touch

  [[nodiscard]] bool any() const noexcept { return amplitude_n_s_per_m != 0.0; }
};

/// Says which setting is out of range and what would do.
/// @return invalid_argument
[[nodiscard]] ASPERITY_API result<void> check(const transient_settings& t);

/// Plays the transient of each first touch, and books its work on the hand.
///
/// A first touch at the speed v takes kinetic energy out of the handle in a real world. A quarter of m v^2, half of it, is
/// what one transient may give the hand, m being the device's moving mass: its force is lowered where the next sample could
/// pass that, and it ends where it has. The guard sees the transient as any other force.
/// @source Kuchenbecker, Fiene and Niemeyer 2006; the bound is ours
/// @rt safe
class contact_transient {
 public:
  static constexpr double slowest_m_per_s = 0.01;  ///< a slower touch is none
  static constexpr double usual_mass_kg = 0.05;    ///< of a device that does not state its own

  /// Settings that check() would refuse play nothing.
  explicit contact_transient(const transient_settings& settings, double moving_mass_kg = 0.0) noexcept
      : settings_(settings),
        used_(settings.any() && is_within(settings)),
        mass_kg_(moving_mass_kg > 0.0 ? moving_mass_kg : usual_mass_kg) {}

  [[nodiscard]] bool used() const noexcept { return used_; }

  /// Forgets what was touched; the next touch is a first one if it comes after quiet_s.
  void reset() noexcept {
    quiet_s_ = 0.0;
    amplitude_n_ = 0.0;
    force_d_ = vec3(0.0);
    before_d_ = vec3(0.0);
    has_last_ = false;
  }

  /// Where the handle has come to, axes of d: books the work of the force that was played.
  void observe(const vec3& position_d) noexcept {
    if (has_last_) {
      const double given_j = glm::dot(force_d_, position_d - last_d_);
      given_j_ += given_j;
      of_this_j_ += given_j;
    }
    last_d_ = position_d;
    has_last_ = true;
  }

  /// The force on the hand for the next sample of dt_s seconds, axes of d.
  /// @param push_d force of the contact on the probe, axes of d
  /// @param velocity_d of the probe, by the device's measure
  /// @param share of it that the hand has: clutched_map::ratio(), or 0 where nothing is put out
  [[nodiscard]] vec3 play(const vec3& push_d, const vec3& velocity_d, double dt_s, double share = 1.0) noexcept {
    if (!used_ || !(dt_s > 0.0)) return force_d_ = vec3(0.0);
    const double push_n = glm::length(push_d);
    const bool touches = push_n > 1e-3;
    if (touches && quiet_s_ >= settings_.quiet_s) begin(push_d / push_n);
    quiet_s_ = touches ? 0.0 : quiet_s_ + dt_s;
    if (!touches) before_d_ = velocity_d;
    return force_d_ = share * next(dt_s);
  }

  /// Work of all transients on the hand since the beginning, J.
  [[nodiscard]] double given_j() const noexcept { return given_j_; }
  [[nodiscard]] std::uint32_t touches() const noexcept { return touches_; }

 private:
  ASPERITY_API static bool is_within(const transient_settings& t) noexcept;

  void begin(const vec3& direction_d) noexcept {
    const double speed = -glm::dot(before_d_, direction_d);
    if (!(speed > slowest_m_per_s)) return;
    direction_d_ = direction_d;
    speed_m_per_s_ = speed;
    amplitude_n_ = std::min(settings_.most_force_n, settings_.amplitude_n_s_per_m * speed);
    budget_j_ = 0.25 * mass_kg_ * speed * speed;
    of_this_j_ = 0.0;
    time_s_ = 0.0;
    ++touches_;
  }

  [[nodiscard]] vec3 next(double dt_s) noexcept {
    constexpr double two_pi = 6.283185307179586;
    constexpr double over = 5.0;  // times the decay: 0.7 % are left
    if (amplitude_n_ == 0.0) return vec3(0.0);
    time_s_ += dt_s;
    const double left_j = budget_j_ - of_this_j_;
    if (time_s_ > over * settings_.decay_s || !(left_j > 0.0)) {
      amplitude_n_ = 0.0;
      return vec3(0.0);
    }
    const double frequency_hz = std::min(settings_.frequency_hz, 0.2 / dt_s);
    const double wanted_n =
        amplitude_n_ * std::exp(-time_s_ / settings_.decay_s) * std::sin(two_pi * frequency_hz * time_s_);
    const double most_n = left_j / (dt_s * speed_m_per_s_);
    return std::clamp(wanted_n, -most_n, most_n) * direction_d_;
  }

  transient_settings settings_;
  bool used_;
  double mass_kg_;
  double quiet_s_ = 0.0;
  vec3 before_d_{0.0};
  bool has_last_ = false;
  vec3 last_d_{0.0};
  vec3 force_d_{0.0};
  vec3 direction_d_{0.0};
  double speed_m_per_s_ = 0.0;
  double amplitude_n_ = 0.0;
  double time_s_ = 0.0;
  double budget_j_ = 0.0;
  double of_this_j_ = 0.0;
  double given_j_ = 0.0;
  std::uint32_t touches_ = 0;
};

}  // namespace asperity
