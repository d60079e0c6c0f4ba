// How far the planes of a control loop look among given bodies.
#pragma once

#include <algorithm>

#include "asperity/model/scene.hpp"
#include "asperity/planes/plane_renderer.hpp"

namespace asperity::command {

/// plane_renderer_settings::reach_m for a loop that wants to know gaps up to this, m, see reach_for(); 0 where what is
/// usual fits, which fits small bodies by itself. A loop below 180 Hz meets fast touches a little late: a longer reach
/// would list whole bodies. One above 3.6 kHz looks further than it has to, because planes are also asked for where the
/// probe will come to rest.
[[nodiscard]] inline double plane_reach_m(const scene& bodies, double wanted_m) {
  constexpr double most_m = 0.01, least_m = 0.0005, of_the_smallest = 0.1;
  const double usual_m = reach_for(1e-3);
  if (wanted_m > usual_m) return std::min(most_m, wanted_m);
  if (wanted_m == usual_m) return 0.0;
  double smallest_m = bodies.probe->box.diagonal();
  for (const model_ptr& b : bodies.fixed) smallest_m = std::min(smallest_m, b->box.diagonal());
  return std::min(of_the_smallest * smallest_m, std::max(least_m, wanted_m));
}

}  // namespace asperity::command
