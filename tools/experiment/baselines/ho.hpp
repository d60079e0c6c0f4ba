// Ho, Basdogan and Srinivasan 1999: the magnitude and the direction of the normal force follow a height map.
#pragma once

#include "baselines/point_reading.hpp"

namespace asperity::baselines {

struct ho_settings {
  double stiffness_n_per_m = 2000.0;
};

/// F = k d M / |M| with d = depth in the displaced surface and M = N - grad h, the normal that bump mapping turns by
/// the slope of the height map h. |F| does not know the slope: the force is not the gradient of anything, and a hand
/// can draw energy from it.
/// @source paper section 2.2 ("alter the magnitude and direction of 3D normal force based on height field gradient");
/// how the two are combined is ours
class ho : public point_model<ho> {
 public:
  explicit ho(const ho_settings& settings = {}) noexcept : settings_(settings) {}

  /// @rt safe
  [[nodiscard]] vec3 force_at(const point_reading& r) const noexcept {
    const double depth_m = r.coarse_depth_m + r.relief_m;
    if (!(depth_m > 0.0)) return vec3(0.0);
    return settings_.stiffness_n_per_m * depth_m * glm::normalize(r.outward_w - r.relief_slope_w);
  }
  [[nodiscard]] double stiffness_n_per_m() const noexcept { return settings_.stiffness_n_per_m; }

 private:
  ho_settings settings_;
};

static_assert(force_model<ho>);

}  // namespace asperity::baselines
