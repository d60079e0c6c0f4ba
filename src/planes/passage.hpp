// Whether a point that moves through a depth field has gone through the body.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/body_field.hpp"

namespace asperity {

/// What a depth field can answer of one body.
struct field_reach {
  double half_m = 0.0;  ///< half the thickness of the body's thinnest parts; without any, its largest smooth depth

  [[nodiscard]] static field_reach of(const body_field& field) noexcept {
    if (field.thickness_m > 0.0) return {0.5 * field.thickness_m};
    float deepest = 0.0F;
    for (const float d : field.smooth.value) deepest = std::max(deepest, d);
    return {static_cast<double>(deepest)};
  }

  /// Overlap up to which a probe that slips round a sharp edge has not gone through it, m: what 20 N press into planes,
  /// and of a thin body half of half of it.
  [[nodiscard]] double shallow_m() const noexcept { return std::clamp(0.5 * half_m, 0.15e-3, 0.5e-3); }

  /// Whether a point of this smooth depth is deeper than the field can answer.
  [[nodiscard]] bool ends_before(const coarse_reading& at) const noexcept {
    constexpr double share = 0.9, least_slope = 0.5;
    const double square = glm::dot(at.slope, at.slope);
    return at.value_m > share * half_m || (at.value_m > 0.5 * half_m && square < least_slope * least_slope);
  }
};

/// Follows one point of another body through a field, from where it touched.
///
/// Everywhere but half way through a body the field has one shortest way out, and its slope is about 1; the slope
/// vanishes where two ways are equally short. A point has passed where its way out points against the one that it had
/// when it was last shallow: it is half way through, or came out on the far side. A point that slips round a body turns
/// its way out while it is shallow.
class passage {
 public:
  [[nodiscard]] bool active() const noexcept { return active_; }
  void forget() noexcept { active_ = false; }

  /// From here on. Both positions are of the same point: in the body that carries it, and in the field's.
  /// @rt safe
  void begin(const vec3& point_x, const vec3& point_y, const body_field& in_y) noexcept {
    const coarse_reading at = in_y.coarse(point_y);
    const double steep = std::sqrt(glm::dot(at.slope, at.slope));
    active_ = steep >= 0.2;  // at a sharp tip the slope is small, and its direction is right
    if (!active_) return;
    point_x_ = point_x;
    point_y_ = point_y;
    inwards_y_ = at.slope / steep;
    deepest_m_ = at.value_m;
    last_ = at;
  }

  /// Goes with the point to where it is now, in steps of half a pitch; at most 32 steps, longer ones where it has gone
  /// further.
  /// @param T_yx of the body that carries the point, in the field's frame
  /// @return whether it passed on the way. It is forgotten then.
  /// @rt safe
  [[nodiscard]] bool go(const pose& T_yx, const body_field& in_y, const field_reach& reach) noexcept {
    if (!active_) return false;
    constexpr double most_steps = 32.0;
    const vec3 to_y = T_yx * point_x_, way = to_y - point_y_;
    const double far = std::sqrt(glm::dot(way, way));
    const double steps = std::min(most_steps, std::max(1.0, std::ceil(2.0 * far / in_y.smooth.pitch_m)));
    for (double i = 1.0; i <= steps; i += 1.0) {
      last_ = in_y.coarse(point_y_ + (i / steps) * way);
      deepest_m_ = std::max(deepest_m_, last_.value_m);
      const double steep = std::sqrt(glm::dot(last_.slope, last_.slope));
      if (!(steep >= least_slope)) continue;
      const vec3 inwards = last_.slope / steep;
      if (deepest_m_ > reach.shallow_m()) {
        if (glm::dot(inwards, inwards_y_) < against) {
          active_ = false;
          return true;
        }
        if (last_.value_m > reach.shallow_m()) continue;
      }
      inwards_y_ = inwards;
      deepest_m_ = last_.value_m;
    }
    point_y_ = to_y;
    return false;
  }

  /// The smooth field where the point is. @pre active()
  [[nodiscard]] const coarse_reading& last() const noexcept { return last_; }

 private:
  static constexpr double least_slope = 0.6;  // of a place with one way out
  static constexpr double against = -0.3;     // cosine: 107 degrees; behind the side wall of a box it is 0

  vec3 point_x_{0.0}, point_y_{0.0};
  vec3 inwards_y_{0.0};     // where the point was last shallow
  double deepest_m_ = 0.0;  // since then
  coarse_reading last_{};
  bool active_ = false;
};

}  // namespace asperity
