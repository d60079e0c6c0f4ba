// Siira and Pai 1996: texture as random forces.
#pragma once

#include <bit>
#include <cstdint>

#include "baselines/point_reading.hpp"

namespace asperity::baselines {

struct siira_pai_settings {
  double stiffness_n_per_m = 2000.0;  ///< of the coarse surface, along its normal
  double lateral_share = 0.2;         ///< standard deviation of the lateral force per normal force
  double normal_share = 0.1;          ///< standard deviation of the normal force per normal force
};

/// F = k d ((1 + a) N + b T) with a and b normally distributed and T a direction across the normal. No height map is
/// read: the texture is its statistics.
/// The numbers come of the point's place, bit by bit: a point that moves at all draws new ones, one that rests keeps
/// them, and the same motion gives the same bits.
/// @source paper section 2.2 ("according to a Gaussian distribution"); shares and the source of chance are ours
class siira_pai : public point_model<siira_pai> {
 public:
  explicit siira_pai(const siira_pai_settings& settings = {}) noexcept : settings_(settings) {}

  /// @rt safe
  [[nodiscard]] vec3 force_at(const point_reading& r) const noexcept {
    if (!(r.coarse_depth_m > 0.0)) return vec3(0.0);
    std::uint64_t state = 0;
    for (int i = 0; i < 3; ++i) state = next(state) ^ std::bit_cast<std::uint64_t>(r.point_w[i]);
    const double a = settings_.normal_share * normal_number(state);
    const vec3 u = any_orthogonal(r.outward_w), v = glm::cross(r.outward_w, u);
    const vec3 across = settings_.lateral_share * (normal_number(state) * u + normal_number(state) * v);
    // A surface does not pull.
    return settings_.stiffness_n_per_m * r.coarse_depth_m * (std::max(0.0, 1.0 + a) * r.outward_w + across);
  }
  [[nodiscard]] double stiffness_n_per_m() const noexcept { return settings_.stiffness_n_per_m; }

 private:
  // SplitMix64.
  [[nodiscard]] static std::uint64_t next(std::uint64_t& state) noexcept {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }
  // The sum of twelve even ones: mean 0, variance 1, never beyond 6, and the same on every machine.
  [[nodiscard]] static double normal_number(std::uint64_t& state) noexcept {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += 0x1p-53 * static_cast<double>(next(state) >> 11);
    return sum;
  }

  siira_pai_settings settings_;
};

static_assert(force_model<siira_pai>);

}  // namespace asperity::baselines
