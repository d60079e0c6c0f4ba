// A sphere around a body, for the first look at which of many bodies can touch.
#pragma once

#include "asperity/core/math.hpp"

namespace asperity {

/// A sphere that holds a body. Body frame, so it is turned and moved with the body and keeps its size.
struct body_sphere {
  vec3 centre_b{0.0};
  double radius_m = 0.0;
};

/// False where nothing of two spheres is within reach_m of each other. Centres in one frame.
/// @rt safe
[[nodiscard]] inline bool may_be_within(double reach_m, const vec3& centre_a, double radius_a_m, const vec3& centre_b,
                                        double radius_b_m) noexcept {
  constexpr double rounding = 1.0 + 1e-9;
  const vec3 apart = centre_b - centre_a;
  const double far_m = rounding * (radius_a_m + radius_b_m + reach_m);
  // What is not a number is not left out.
  return !(glm::dot(apart, apart) > far_m * far_m);
}

}  // namespace asperity
