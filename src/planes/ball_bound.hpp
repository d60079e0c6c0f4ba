// How deep the points of a small ball can lie in a depth field, from one quick reading.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/pose.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/sample_tree.hpp"
#include "asperity/planes/near_samples.hpp"
#include "field/quick_read.hpp"

namespace asperity {

/// Bounds the depth of all samples of a ball of a body X in the field of Y; T_yx takes X's frame to Y's. The smooth
/// part grows by its second-order expansion at the centre and what its third derivatives can add; the relief is at most
/// the highest at the feet of the ball's points, which lie next to the centre's.
/// @rt safe
[[nodiscard, gnu::flatten]] inline depth_bound bound_of_ball(const body_field& in_y, const pose& T_yx,
                                                             const sample_ball& ball_x) noexcept {
  // A smooth distance grows by little more than a metre per metre; beyond the grid by one along it and one across it.
  constexpr double steepest = 1.2, steepest_beyond = 1.5;
  const vec3 centre_y = T_yx * ball_x.centre_b;
  const double radius_m = ball_x.radius_m;
  const detail::quick_reading read = detail::quick_read(in_y.smooth, centre_y);
  depth_bound out;
  out.smooth_m = read.at.value_m + read.error_m;
  out.slope = read.at.slope;
  out.relief_m = in_y.highest_relief_m;
  const vec3 low = centre_y - radius_m, high = centre_y + radius_m;
  const bool inside = in_y.smooth.clamped(low) == low && in_y.smooth.clamped(high) == high;
  double grows_m = (inside ? steepest : steepest_beyond) * radius_m;
  const double third = inside ? in_y.most_third.most_per_m2(centre_y, radius_m) : depth_bound::unknown;
  if (std::isfinite(third)) {
    out.third_per_m2 = third;
    out.hessian_per_m = read.at.hessian_per_m;
    const mat3& h = out.hessian_per_m;
    const double bend = std::sqrt(glm::dot(h[0], h[0]) + glm::dot(h[1], h[1]) + glm::dot(h[2], h[2]));
    const double slope_growth_m = ball_x.growth(glm::conjugate(T_yx.rotation) * out.slope);
    grows_m = std::min(grows_m, slope_growth_m + (0.5 * bend + third * radius_m / 6.0) * radius_m * radius_m);
    // The derivative of a foot by its point is I - a g g^T - a S (I - 2 a g g^T) H with a = 1 / |g|^2: a projection
    // less a reflection of a S H. So a foot goes no further than its point does, and a |S| H beside it.
    const double most_bend = bend + third * radius_m;
    const double least_slope = std::max(0.0, std::sqrt(glm::dot(out.slope, out.slope)) - most_bend * radius_m);
    const double mean_depth_m = std::fabs(out.smooth_m) + 0.5 * steepest * radius_m;
    const double apart = 1.0 + mean_depth_m * most_bend / (least_slope * least_slope + 1e-3);
    constexpr double no_longer_near = 10.0;
    if (apart < no_longer_near) {
      const vec3 foot_y = in_y.foot(centre_y, read.at).foot_b;
      out.relief_m = std::min(out.relief_m, in_y.most_relief.most_m(foot_y, apart * radius_m + read.error_m));
    }
  }
  out.most_m = out.smooth_m + grows_m + out.relief_m;
  return out;
}

}  // namespace asperity
