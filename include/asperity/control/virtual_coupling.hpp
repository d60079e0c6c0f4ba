// The spring and damper between the device's handle and the probe.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
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
/// A stiffness that the device does not state (0) leaves the coupling's default.
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
  const auto bounded = [&](double stiffness, double peak, double least_way) {
    const double stable = share * slower * stiffness;
    return peak > 0.0 ? std::min(stable, peak / least_way) : stable;
  };
  coupling_settings out;
  out.max_damping_n_s_per_m /= scale * scale;
  if (device.max_stiffness_n_per_m > 0.0) {
    out.stiffness_n_per_m =
        bounded(device.max_stiffness_n_per_m, device.peak_force_n, least_stretch_m) / (scale * scale);
  }
  if (device.max_stiffness_n_m_per_rad > 0.0) {
    out.stiffness_n_m_per_rad = bounded(device.max_stiffness_n_m_per_rad, device.peak_torque_n_m, least_turn_rad);
  }
  return out;
}

}  // namespace asperity
