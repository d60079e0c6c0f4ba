// How stiff the virtual coupling may be on a device, from what the device states of itself.
#pragma once

#include <algorithm>

#include "asperity/control/virtual_coupling.hpp"
#include "asperity/device/capabilities.hpp"

namespace asperity {

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
/// @param scale workspace_map::scale; a device's K is K / scale^2 in the world, and its force F is F / scale
/// @pre rate_hz > 0, scale > 0
[[nodiscard]] inline coupling_config coupling_for(const device_capabilities& device, double rate_hz,
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
  coupling_config out;
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
