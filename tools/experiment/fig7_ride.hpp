// The paper's Fig. 7 as a motion: a textured block drawn over the ridges of a gear, and what is read off it.
#pragma once

#include <array>
#include <vector>

#include "asperity/core/math.hpp"
#include "trial.hpp"
#include "workbench.hpp"

namespace asperity::experiment {

/// How the hand draws the block. The contact plane leans in y and z, so that a step along the plane shows in both.
struct ride_settings {
  double lean_rad = 0.6108652381980153;       ///< of the contact plane's normal against y: 35 degrees
  double press_n = 0.9;                       ///< how far the hand goes on past the deepest notch, times the coupling
  double drive_m_per_s = 7e-3;                ///< along the plane, across the ridges
  double sway_m = 2e-3, sway_period_s = 1.5;  ///< along the ridges; the gear is longer than that
  double touch_s = 0.2;                       ///< how long the hand takes to come down
  double drive_from_s = 0.25, judged_from_s = 0.5;
  double seconds = 3.0;
  double probe_mass_kg = 0.05;
  std::int64_t contact_period_ns = 2'000'000;  ///< as in the paper: 1500 frames in 3 s
  bool contact_one_period_late = false;
};

/// The unit vectors of the leaning plane, world axes.
struct ride_axes {
  vec3 along;  ///< across the ridges, where the hand draws
  vec3 into;   ///< from the block into the gear
};
[[nodiscard]] ride_axes axes_of(const ride_settings& with);

/// One ride, one entry for every device tick.
struct ride {
  std::vector<double> time_s;
  std::array<std::vector<double>, 3> moved_m;  ///< of the block from its start, world axes
  std::array<std::vector<double>, 3> hand_m;   ///< of the hand from there
  std::array<std::vector<double>, 3> force_n;  ///< of the contact, on the block
  std::vector<double> along_m;                 ///< the block along the plane; a notch at every wavelength
  std::vector<double> wind_up_m;               ///< how far the block is behind the hand, along the plane
  std::vector<double> along_n;                 ///< how the gear holds it back
  std::vector<double> pressure_m;              ///< where the force meets the mid plane, along it from the gear's crown
};

/// @return what run_trial or the models say
[[nodiscard]] result<ride> draw_over_gear(workbench& bench, const variant& kind, const ride_settings& with);

/// What a ride comes to, from judged_from_s on.
struct ride_figures {
  double across_share = 0.0;  ///< largest |F_x| over largest |F|
  double dwell = 0.0;  ///< share of the time in which the block is slower along the plane than a fifth of the drive
  double wind_up_correlation = 0.0;  ///< of the force along the plane with the wind-up
  double pressure_m = 0.0;       ///< largest distance of the centre of pressure from the gear's crown, along the plane
  std::vector<double> rest_z_m;  ///< height of every rest of 50 ms or more
};
[[nodiscard]] ride_figures figures_of(const ride& r, const ride_settings& with);

}  // namespace asperity::experiment
