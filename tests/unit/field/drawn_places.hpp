// Places and directions that a test draws.
#pragma once

#include <cmath>
#include <random>

#include "asperity/core/math.hpp"

namespace asperity::test_support {

struct drawn_places {
  std::mt19937_64 bits;

  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(bits); }
  vec3 direction() {
    std::normal_distribution<double> n;
    return glm::normalize(vec3(n(bits), n(bits), n(bits)));
  }
  vec3 in_ball(double radius_m) { return radius_m * std::cbrt(unit()) * direction(); }
};

}  // namespace asperity::test_support
