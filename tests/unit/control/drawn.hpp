// Numbers and vectors from one stream of random bits.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "asperity/core/math.hpp"

namespace asperity::test_support {

/// The same in every standard library, which std::uniform_real_distribution is not.
struct drawn {
  std::mt19937_64 bits;
  explicit drawn(std::uint64_t seed) : bits(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1.0p-53);
  }
  double log_between(double low, double high) { return low * std::pow(high / low, between(0.0, 1.0)); }
  vec3 direction() {
    const double z = between(-1.0, 1.0);
    const double a = between(0.0, 6.283185307179586);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
  }
  vec3 inside(double radius) { return radius * between(0.0, 1.0) * direction(); }
};

}  // namespace asperity::test_support
