#include "asperity/drivers/falcon/falcon_torque.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace asperity {

std::array<std::int16_t, 3> falcon_counts_for(const vec3& grip_d, const falcon_angles& angles, const vec3& force_d,
                                              std::int16_t limit_counts) noexcept {
  if (!is_finite(force_d) || !is_finite(grip_d)) return {};
  // A force beyond all devices is shortened first, so that nothing below overflows.
  constexpr double beyond_n = 1e6;
  const double largest = std::max({std::fabs(force_d.x), std::fabs(force_d.y), std::fabs(force_d.z)});
  const vec3 force =
      largest > beyond_n ? vec3(force_d.x / largest, force_d.y / largest, force_d.z / largest) * beyond_n : force_d;
  const std::optional<vec3> torques = falcon_torques(grip_d, angles, force);
  if (!torques) return {};
  const vec3 wanted = falcon_counts_per_n_m * *torques;
  const double most = std::max({std::fabs(wanted.x), std::fabs(wanted.y), std::fabs(wanted.z)});
  const double limit = std::clamp<double>(limit_counts, 0.0, falcon_counts_limit);
  const double scale = most > limit ? limit / most : 1.0;
  std::array<std::int16_t, 3> counts{};
  for (std::size_t i = 0; i < 3; ++i) counts[i] = falcon_motor_counts(scale * wanted[static_cast<int>(i)]);
  return counts;
}

}  // namespace asperity
