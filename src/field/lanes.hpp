// Four floats in one register, for loops over four that compilers do not vectorise by themselves.
#pragma once

#include <cstring>

namespace asperity::detail {

/// Four floats that are added and multiplied together, one machine register. A type of GCC and Clang.
using lanes = float __attribute__((vector_size(16)));

[[nodiscard]] inline lanes load_lanes(const float* from) noexcept {
  lanes out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

inline void store_lanes(const lanes& v, float* to) noexcept { std::memcpy(to, &v, sizeof v); }

[[nodiscard]] inline float sum_of(const lanes& v) noexcept { return (v[0] + v[1]) + (v[2] + v[3]); }

}  // namespace asperity::detail
