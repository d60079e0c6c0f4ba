// What the search for ways out may have left out.
#pragma once

namespace asperity::exits {

/// What a solve had to leave out.
struct exit_limits_hit {
  bool readings = false;   ///< least_motion_settings::most_readings: ways out may be missing
  bool marks = false;      ///< least_motion_settings::most_samples: the bed of one way out is incomplete
  bool unsettled = false;  ///< a way out with weight did not come to rest
  bool rounds = false;     ///< the weights still changed at the last round

  [[nodiscard]] bool any() const noexcept { return readings || marks || unsettled || rounds; }
};

}  // namespace asperity::exits
