#include "asperity/window/window_depth_settings.hpp"

#include <cmath>
#include <string>

namespace asperity {

result<void> check(const window_depth_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "depth settings: " + what}; };
  if (s.grid < 2 || s.grid > window_depth_settings::max_grid) {
    return bad("grid is " + std::to_string(s.grid) + "; give 2 to " + std::to_string(window_depth_settings::max_grid) +
               " samples per side");
  }
  const auto length = [](double x) { return std::isfinite(x) && x >= 0.0; };
  if (!length(s.tau_m)) return bad("tau_m must be a finite length, or 0 for automatic");
  if (!length(s.reference_area_m2)) return bad("reference_area_m2 must be a finite area, or 0 for automatic");
  if (!length(s.difference_step_m)) return bad("difference_step_m must be a finite length, or 0 for automatic");
  if (!length(s.taper_m)) return bad("taper_m must be a finite length, or 0 for automatic");
  if (!(s.facing_cosine > 0.0 && s.facing_cosine <= 0.5)) return bad("facing_cosine must be above 0 and at most 0.5");
  return {};
}

}  // namespace asperity
