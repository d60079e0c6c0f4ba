// Rounding to single precision and back: what a number is after it has been in a file or on a GPU.
#pragma once

#include "asperity/core/math.hpp"

namespace asperity {

/// The float32 nearest to x, as a double.
/// Goes through a volatile because GCC 12 at -O2 drops the pair of conversions where it vectorises two of them, and
/// the number comes back unrounded in optimised builds only.
/// @rt safe
[[nodiscard]] inline double round_to_float32(double x) noexcept {
  const volatile float rounded = static_cast<float>(x);
  return static_cast<double>(rounded);
}

/// @rt safe
[[nodiscard]] inline vec2 round_to_float32(const vec2& v) noexcept {
  return {round_to_float32(v.x), round_to_float32(v.y)};
}

/// @rt safe
[[nodiscard]] inline vec3 round_to_float32(const vec3& v) noexcept {
  return {round_to_float32(v.x), round_to_float32(v.y), round_to_float32(v.z)};
}

}  // namespace asperity
