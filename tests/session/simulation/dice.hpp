// Where all chance of a simulated session comes from: one number, the seed.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "asperity/core/math.hpp"

namespace asperity::simulation {

/// Small seeded generator (splitmix64). Every draw is a function of the seed and of how many draws came before.
class dice {
 public:
  explicit dice(std::uint64_t seed) noexcept : state_(seed) {}

  [[nodiscard]] std::uint64_t bits() noexcept {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1).
  [[nodiscard]] double unit() noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  [[nodiscard]] bool chance(double probability) noexcept { return unit() < probability; }
  [[nodiscard]] double between(double low, double high) noexcept { return low + (high - low) * unit(); }
  /// Uniform in the logarithm: each factor of two is as likely as the next. @pre 0 < low
  [[nodiscard]] double log_between(double low, double high) noexcept { return low * std::pow(high / low, unit()); }
  /// One of 0 ... n - 1. @pre n > 0
  [[nodiscard]] std::size_t below(std::size_t n) noexcept { return static_cast<std::size_t>(bits() % n); }
  [[nodiscard]] std::int64_t between_ns(double low_ms, double high_ms) noexcept {
    return static_cast<std::int64_t>(1e6 * between(low_ms, high_ms));
  }
  [[nodiscard]] vec3 direction() noexcept {
    const double z = between(-1.0, 1.0);
    const double angle = between(0.0, 6.283185307179586);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace asperity::simulation
