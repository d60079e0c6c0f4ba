// How deep a point lies in a body: a smooth signed distance plus the relief of the fine surface over it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/field/coarse_grid.hpp"
#include "asperity/field/relief_bounds.hpp"
#include "asperity/field/relief_bricks.hpp"
#include "asperity/field/slope_boxes.hpp"
#include "asperity/field/third_bounds.hpp"

namespace asperity {

/// A depth and its derivative by the point's position. Body frame, positive inside.
struct field_reading {
  double value_m = 0.0;
  vec3 slope{0.0};
};

/// Where a point's relief is read.
struct foot_and_fade {
  vec3 foot_b{0.0};
  double fade = 0.0;        ///< 1 near the surface and wherever S has a direction, 0 half way through a body
  double fade_slope = 0.0;  ///< derivative of the fade by |grad S|^2
  double by_value = 0.0;    ///< derivative of the fade by S, divided by fade_slope
  double per_square = 0.0;  ///< 1 / |grad S|^2, kept finite
};

/// Depth field of one body, metres, positive inside: D(p) = S(p) + t(foot(p)).
///
/// S is a signed distance to the fine surface, low-passed at the grid's pitch, with two continuous derivatives. t is
/// the relief over the surface S = 0, so that D = 0 on the fine surface; it is read at the foot of a point, foot(p) = p
/// - S grad S / |grad S|^2, and so keeps the texture at any depth. Where the smooth distance has no direction (half way
/// through a body, |S| well above the pitch) the relief fades out.
///
/// Both parts can be read apart: a law may move the body and keep the relief of the pose where it started.
/// Immutable once made; every function is real-time safe, of fixed cost, and may be called from any thread.
struct body_field {
  detail::coarse_grid smooth;
  detail::relief_bricks fine;
  detail::third_bounds most_third;          ///< of the smooth part
  detail::relief_bounds most_relief;        ///< of the fine part
  detail::slope_boxes slopes;               ///< of both, near the surface
  static constexpr double slopes_to = 3.0;  ///< they were measured up to so many pitches off the surface
  static constexpr double fade_none = 0.4;  ///< |grad S|^2 above which relief counts in part, far from the surface
  static constexpr double fade_full = 0.8;  ///< |grad S|^2 above which it counts in full
  static constexpr double distance_slack = 0.25;         ///< largest error of swept distances, in pitches
  double lowest_relief_m = 0.0, highest_relief_m = 0.0;  ///< bounds of the relief; at most and at least 0
  double thickness_m = 0.0;          ///< of the thinnest parts of the body; 0 where no two walls face each other
  double thinnest_resolved_m = 0.0;  ///< parts thinner than this are blurred: three pitches of the smooth part

  /// S with its derivatives. Beyond the grid it goes on, negative and falling.
  [[nodiscard]] coarse_reading coarse(const vec3& p_b) const noexcept { return smooth.read(p_b); }

  /// t(foot(p)), faded, and its slope by p: the chain rule through foot and fade, exact. Zero beyond the grid, where S
  /// is far below zero.
  /// @param at coarse(p_b)
  [[nodiscard]] field_reading relief(const vec3& p_b, const coarse_reading& at) const noexcept {
    if (smooth.clamped(p_b) != p_b) return {};
    const foot_and_fade to = foot(p_b, at);
    if (!(to.fade > 0.0)) return {};
    return faded(fine.read(to.foot_b), to, at);
  }

  /// A relief as a function of the point, from what was read at its foot.
  /// @param to foot(p_b, at)   @param at coarse(p_b)
  [[nodiscard]] static field_reading faded(const detail::relief_bricks::reading& t, const foot_and_fade& to,
                                           const coarse_reading& at) noexcept {
    const vec3& g = at.slope;
    const double s = at.value_m, a = to.per_square;
    const vec3 bent = at.hessian_per_m * g;
    const double along = glm::dot(g, t.slope);
    const vec3 by_foot =
        t.slope - a * along * g - s * a * (at.hessian_per_m * t.slope) + 2.0 * s * a * a * along * bent;
    const vec3 by_fade = to.fade_slope * (2.0 * bent + to.by_value * g);
    return {to.fade * t.value, to.fade * by_foot + t.value * by_fade};
  }

  /// Where the relief of a point is read, and how much of it counts.
  /// @param at coarse(p_b)
  [[nodiscard]] foot_and_fade foot(const vec3& p_b, const coarse_reading& at) const noexcept {
    const double s = at.value_m, square = glm::dot(at.slope, at.slope);
    // x is large next to the surface, whatever the slope, and follows |grad S|^2 far from it.
    const double pitch2 = smooth.pitch_m * smooth.pitch_m, near = pitch2 / (pitch2 + s * s);
    const double x = (square + fade_full * near - fade_none) / (fade_full - fade_none);
    foot_and_fade out;
    // The small addend keeps the quotient finite; it moves the foot by a thousandth of the depth along the normal,
    // along which the relief hardly changes.
    out.per_square = 1.0 / (square + 1e-3);
    out.foot_b = p_b - s * out.per_square * at.slope;
    out.fade = smoothstep(x);
    out.fade_slope = smoothstep_slope(x) / (fade_full - fade_none);
    out.by_value = -2.0 * fade_full * s * near * near / pitch2;
    return out;
  }

  /// D and its slope.
  [[nodiscard]] field_reading read(const vec3& p_b) const noexcept {
    const coarse_reading at = coarse(p_b);
    const field_reading t = relief(p_b, at);
    return {at.value_m + t.value_m, at.slope + t.slope};
  }

  /// Upper bound of D in a ball, from one node. Never below the truth; above it by up to 2.1 pitches, the relief's
  /// range and twice the radius.
  ///
  /// The nodes hold a signed distance, which changes by a metre per metre at most. The spline's weights about a point
  /// have a root mean square distance of one pitch from it, so the spline lies at most a pitch above the distance.
  [[nodiscard]] double most_near(const vec3& p_b, double radius_m) const noexcept {
    const vec3 c_b = smooth.clamped(p_b), beyond = p_b - c_b;
    const double away = std::sqrt(glm::dot(beyond, beyond));
    return smooth.most_beside(c_b) + radius_m + (1.0 + distance_slack) * smooth.pitch_m + highest_relief_m -
           std::max(0.0, away - radius_m);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(smooth, fine, most_third, most_relief, slopes);
  }
};

}  // namespace asperity
