// How stiff the virtual coupling may be at 1 kHz.
#pragma once

#include <vector>

#include "experiment.hpp"

namespace asperity::experiment {

/// The limit for one damping of the coupling.
struct coupling_limit {
  double damping_n_s_per_m = 0.0;
  double measured_n_per_m = 0.0;  ///< stiffest at which a kicked hand comes to rest
  double theory_n_per_m = 0.0;    ///< the same from the poles of the sampled loop
  double passive_n_per_m = 0.0;   ///< stiffest that is passive in whatever hand: 2 (b - B) / T; 0: none is
};

/// Damping of the hand that holds the handle, and its mass with the handle's.
inline constexpr double kicked_damping_n_s_per_m = 5.0;
inline constexpr double kicked_mass_kg = 0.1;

/// A tool too heavy to move stands for one that a rigid contact holds. A hand of 0.1 kg and 5 N s/m is kicked.
/// @return the trial's error
[[nodiscard]] result<std::vector<coupling_limit>> coupling_limits(workbench& bench,
                                                                  const std::vector<double>& dampings_n_s_per_m);

}  // namespace asperity::experiment
