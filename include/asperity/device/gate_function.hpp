// The arithmetic of the output gate: one vector, one straight line of selects, one certificate at the end.
//
// Nothing here branches, loops, calls a library beyond sqrt, or remembers anything, so that the compiled function can
// be translated and proved for every bit pattern of its inputs.
#pragma once

#include <cmath>

#include "asperity/core/math.hpp"

#ifdef __FAST_MATH__
#error "asperity: the output gate rests on comparisons that NaN fails, and -ffast-math removes them; build without it"
#endif

namespace asperity {

/// What one vector (a force or a torque) may be in this tick. Newtons or newton metres throughout.
struct vector_bound {
  double limit = 0.0;       ///< largest length that may ever leave; certified
  double saturation = 0.0;  ///< length to shorten to in this tick, <= limit (thermal derating)
  double max_change = 0.0;  ///< largest change of the output in this tick (slew rate times tick length)
};

/// What the gate lets through of one vector.
struct bounded_vector {
  vec3 value{0.0};
  bool finite = false;     ///< the wanted vector was a vector of ordinary numbers below 1e150
  bool certified = false;  ///< the value that leaves was measured and is within the limit; otherwise it is zero
};

/// Finite, direction-keeping saturation, slew about the previous output, certificate.
/// Where `allowed` is false or `wanted` is not finite, the target is zero and the slew rate takes the output there.
/// The certificate measures what is about to leave, whatever happened above it: a failed comparison, which NaN always
/// is, selects zero at once.
/// @pre 0 <= saturation <= limit <= 1e6, |previous| <= limit
/// @rt safe: straight line
[[nodiscard]] inline bounded_vector bound_vector(const vec3& wanted, const vec3& previous, const vector_bound& bound,
                                                 bool allowed) noexcept {
  constexpr double largest = 1e150;  // squares stay finite below it; NaN and infinity fail the comparison
  const bool finite =
      (std::fabs(wanted.x) <= largest) & (std::fabs(wanted.y) <= largest) & (std::fabs(wanted.z) <= largest);
  const bool open = finite & allowed;
  double x = open ? wanted.x : 0.0;
  double y = open ? wanted.y : 0.0;
  double z = open ? wanted.z : 0.0;

  // One factor for three components keeps the direction: a clamp per axis would push along an edge of a cube.
  const double length = std::sqrt(x * x + y * y + z * z);
  const double shrink = length > bound.saturation ? bound.saturation / length : 1.0;
  x *= shrink;
  y *= shrink;
  z *= shrink;

  const double dx = x - previous.x;
  const double dy = y - previous.y;
  const double dz = z - previous.z;
  const double change = std::sqrt(dx * dx + dy * dy + dz * dz);
  const double part = change > bound.max_change ? bound.max_change / change : 1.0;
  x = previous.x + dx * part;
  y = previous.y + dy * part;
  z = previous.z + dz * part;

  const double measured = x * x + y * y + z * z;
  const bool certified =
      measured <= bound.limit * bound.limit * 1.00000001;  // room for the rounding of the lines above
  return {{certified ? x : 0.0, certified ? y : 0.0, certified ? z : 0.0}, finite, certified};
}

}  // namespace asperity
