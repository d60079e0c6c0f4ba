// How nearly two contact directions are the same.
#pragma once

#include <cmath>

#include "asperity/core/math.hpp"

namespace asperity::detail {

/// K of two unit directions: 1 up to one angle between them, 0 from another on, smooth between. Contacts whose K is 1
/// share a spring, those whose K is 0 have one each.
/// @rt safe   @source science, section 3.4
class direction_sameness {
 public:
  /// @pre same_rad < other_rad
  direction_sameness(double same_rad, double other_rad) noexcept
      : cos_other_(std::cos(other_rad)), width_(std::cos(same_rad) - cos_other_) {}

  [[nodiscard]] double operator()(const vec3& n, const vec3& m) const noexcept {
    return smoothstep((glm::dot(n, m) - cos_other_) / width_);
  }
  /// Derivative by the cosine between the two.
  [[nodiscard]] double slope(const vec3& n, const vec3& m) const noexcept {
    return smoothstep_slope((glm::dot(n, m) - cos_other_) / width_) / width_;
  }

 private:
  double cos_other_, width_;
};

}  // namespace asperity::detail
