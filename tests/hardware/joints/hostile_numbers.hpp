// Numbers that nobody means: NaN, infinities, denormals, the neighbourhood of a limit, and random bit patterns.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace asperity::test_support {

/// Calls f with some 20,000 numbers of either sign; the same ones every time. `scale` is where limits lie.
template <class F>
void for_hostile_numbers(double scale, F&& f) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const double fixed[] = {0.0,
                          std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::signaling_NaN(),
                          inf,
                          std::numeric_limits<double>::max(),
                          std::numeric_limits<double>::min(),
                          std::numeric_limits<double>::denorm_min(),
                          1e300,
                          1e38,
                          3.5e38,
                          1e19,
                          2147483647.5,
                          4294967296.0,
                          65536.0,
                          32768.0,
                          1e-30,
                          1e-3,
                          0.5,
                          1.0};
  for (const double x : fixed) {
    f(x);
    f(-x);
  }
  for (const double share : {1.0, 0.5, 0.25, 0.123, 0.001, 1.0 / 4095.0, 3.0 / 4095.0}) {
    for (const double x : {std::nextafter(scale * share, 0.0), scale * share, std::nextafter(scale * share, inf)}) {
      f(x);
      f(-x);
    }
  }
  std::mt19937_64 bits(42);
  for (int i = 0; i < 10'000; ++i) {
    f(std::bit_cast<double>(bits()));
    const double unit = static_cast<double>(bits() >> 11) * 0x1.0p-53;
    f((unit * 2.0 - 1.0) * 1.2 * scale);
  }
}

}  // namespace asperity::test_support
