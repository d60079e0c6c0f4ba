// Numbers on the wire that never exceed what was asked for.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace asperity {

/// The value within +-limit; 0 for what is not finite.
/// @pre limit >= 0
[[nodiscard]] constexpr double saturated(double value, double limit) noexcept {
  const bool finite = value <= std::numeric_limits<double>::max() && value >= std::numeric_limits<double>::lowest();
  return finite ? std::clamp(value, -limit, limit) : 0.0;
}

/// The float nearest to a double on the side of zero; 0 for what is not finite.
[[nodiscard]] constexpr float float_toward_zero(double value) noexcept {
  constexpr double largest = std::numeric_limits<float>::max();
  const double wanted = saturated(value, largest);
  const float nearest = static_cast<float>(wanted);
  const double back = static_cast<double>(nearest);
  const bool over = wanted < 0.0 ? back < wanted : back > wanted;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) - (over ? 1U : 0U));
}

/// A torque as a float on the wire: within +-limit, rounded towards zero.
/// @pre limit >= 0
[[nodiscard]] constexpr float wire_float(double value, float limit) noexcept {
  return float_toward_zero(saturated(value, static_cast<double>(limit)));
}

/// A number in units of `unit`, rounded towards zero and within +-`most`.
/// @pre unit > 0; 0 <= most <= 2^48
[[nodiscard]] constexpr std::int64_t wire_count(double value, double unit, double most) noexcept {
  const double wanted = saturated(value, std::numeric_limits<double>::max());
  const double size = wanted < 0.0 ? -wanted : wanted;
  const double share = size * (1.0 / unit);
  auto n = static_cast<std::int64_t>(share < most ? share : most);
  // Rounded twice: it can step over a whole number, or stop short of it.
  n -= n > 0 && static_cast<double>(n) * unit > size ? 1 : 0;
  n += static_cast<double>(n + 1) <= most && static_cast<double>(n + 1) * unit <= size ? 1 : 0;
  return wanted < 0.0 ? -n : n;
}

// Bytes of the wire. The callers know that there are enough.
[[nodiscard]] constexpr std::uint32_t little_u32(const std::uint8_t* b) noexcept {
  return static_cast<std::uint32_t>(b[0]) | static_cast<std::uint32_t>(b[1]) << 8U |
         static_cast<std::uint32_t>(b[2]) << 16U | static_cast<std::uint32_t>(b[3]) << 24U;
}
[[nodiscard]] constexpr float little_float(const std::uint8_t* b) noexcept {
  return std::bit_cast<float>(little_u32(b));
}
constexpr void put_little_u32(std::uint8_t* b, std::uint32_t value) noexcept {
  for (unsigned i = 0; i < 4; ++i) b[i] = static_cast<std::uint8_t>(value >> (8U * i));
}
constexpr void put_little_float(std::uint8_t* b, float value) noexcept {
  put_little_u32(b, std::bit_cast<std::uint32_t>(value));
}

}  // namespace asperity
