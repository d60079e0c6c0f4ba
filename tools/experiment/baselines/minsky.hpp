// Minsky 1995: a lateral force against the slope of a height map.
#pragma once

#include "baselines/point_reading.hpp"

namespace asperity::baselines {

struct minsky_settings {
  double stiffness_n_per_m = 2000.0;  ///< of the coarse surface, along its normal
  double lateral_n = 0.5;             ///< lateral force per unit slope of the relief, N
  bool grows_with_pressure = false;   ///< lateral force per unit slope is the normal force instead
};

/// F = k d N - g grad h. d is the depth in the coarse surface, N its normal, h the height map under the point; g is a
/// constant, or k d where the lateral force shall grow with the pressure. With a constant g the force has a potential;
/// with g = k d it has none, and a hand can draw energy from it.
/// @source paper section 2.2 ("proportional to the gradient of a 2D height field"); gains are ours
class minsky : public point_model<minsky> {
 public:
  explicit minsky(const minsky_settings& settings = {}) noexcept : settings_(settings) {}

  /// @rt safe
  [[nodiscard]] vec3 force_at(const point_reading& r) const noexcept {
    if (!(r.coarse_depth_m > 0.0)) return vec3(0.0);
    const double normal_n = settings_.stiffness_n_per_m * r.coarse_depth_m;
    const double lateral_n = settings_.grows_with_pressure ? normal_n : settings_.lateral_n;
    return normal_n * r.outward_w - lateral_n * r.relief_slope_w;
  }
  [[nodiscard]] double stiffness_n_per_m() const noexcept { return settings_.stiffness_n_per_m; }

 private:
  minsky_settings settings_;
};

static_assert(force_model<minsky>);

}  // namespace asperity::baselines
