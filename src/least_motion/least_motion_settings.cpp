#include "asperity/least_motion/least_motion_settings.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace asperity {

contact_softness softness_for(double period_s, double texel_m) noexcept {
  constexpr double speed_m_per_s = 0.05;
  const double travel_m = speed_m_per_s * period_s;
  contact_softness out;
  out.softness_m = std::max(1e-6, std::min(0.3 * travel_m, 0.25 * texel_m));
  out.sharpness = std::clamp(4.0 * std::sqrt(50e-6 / travel_m), 3.0, 12.0);
  return out;
}

result<void> check(const least_motion_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "least motion: " + what}; };
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m > 0.0)) {
    return bad("stiffness_n_per_m must be a finite number above 0");
  }
  if (!(std::isfinite(s.softness_m) && s.softness_m >= 0.0)) {
    return bad("softness_m must be a finite length, or 0 for automatic");
  }
  if (!(s.sharpness == 0.0 || (std::isfinite(s.sharpness) && s.sharpness >= 2.0))) {
    return bad("sharpness must be a finite number of at least 2, or 0 for automatic");
  }
  if (!(std::isfinite(s.turn_arm_m) && s.turn_arm_m >= 0.0)) {
    return bad("turn_arm_m must be a finite length, or 0 for automatic");
  }
  if (!(std::isfinite(s.period_s) && s.period_s > 0.0)) return bad("period_s must be a finite time above 0");
  if (s.most_readings < 1000) return bad("most_readings must be 1000 or more");
  if (s.most_samples < 64) return bad("most_samples must be 64 or more");
  return {};
}

}  // namespace asperity
