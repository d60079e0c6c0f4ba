// How much deeper a small motion can take the samples of a patch.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/math.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/slope_boxes.hpp"
#include "asperity/planes/near_samples.hpp"

namespace asperity {

/// No depth in a field grows faster than this with the way of its point: smooth part and relief together.
inline constexpr double steepest_depth = 3.0;

/// A motion of a patch in the frame of the field that it is read in.
struct patch_way {
  vec3 of_middle{0.0};     ///< how far the middle of the patch's ball has gone
  double of_turn_m = 0.0;  ///< how much further or less far any of its points can have

  /// No point of the patch has gone further. @rt safe
  [[nodiscard]] double most_m() const noexcept { return std::sqrt(glm::dot(of_middle, of_middle)) + of_turn_m; }
};

/// Which slopes a depth field can have about a patch: those that were measured there, and up to not_measured beside
/// them. Where a face is plain they are nearly one, and a motion along it makes no sample deeper.
///
/// Not proved: what was measured is at points a texel apart.
struct patch_slopes {
  static constexpr double not_measured = 0.15;  ///< m per m

  detail::slope_boxes::box measured{};
  double within_m = -1.0;  ///< of the middle of the ball; below 0: nothing is known

  /// No sample grows deeper by more, m.
  /// @param far_m no sample is further from the middle of the ball on the way   @rt safe
  [[nodiscard]] double growth_m(const patch_way& way, double far_m) const noexcept {
    const double along_m = std::sqrt(glm::dot(way.of_middle, way.of_middle));
    const double at_most_m = steepest_depth * (along_m + way.of_turn_m);
    if (!(far_m <= within_m)) return at_most_m;
    const vec3 low(measured.low), high(measured.high);
    const vec3 by_axis = glm::max(low * way.of_middle, high * way.of_middle), longest = glm::max(-low, high);
    const double steep = std::sqrt(glm::dot(longest, longest)) + not_measured;
    return std::min(at_most_m, by_axis.x + by_axis.y + by_axis.z + not_measured * along_m + steep * way.of_turn_m);
  }
};

/// The slopes within far_m of the middle of a patch, where slopes were measured: up to three pitches off the surface.
/// @param at of the patch's ball in this field   @rt safe
[[nodiscard]] inline patch_slopes slopes_about(const body_field& in_y, const vec3& middle_y, double far_m,
                                               const depth_bound& at) noexcept {
  constexpr double steepest_smooth = 1.2;
  const bool measured = std::fabs(at.smooth_m) + steepest_smooth * far_m < body_field::slopes_to * in_y.smooth.pitch_m;
  if (!measured) return {};
  const detail::slope_boxes::box of = in_y.slopes.around(middle_y, far_m);
  return of.known() ? patch_slopes{of, far_m} : patch_slopes{};
}

}  // namespace asperity
