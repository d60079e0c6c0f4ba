#include "asperity/drivers/falcon/falcon_kinematics.hpp"

#include <cmath>
#include <cstddef>
#include <optional>

#include "asperity/drivers/falcon/falcon_leg.hpp"

namespace asperity {
namespace {

// x with sum of columns[i] * x[i] = b; nothing where the columns are nearly in a plane, or not finite.
std::optional<vec3> solve_columns(const mat3& columns, const vec3& b) noexcept {
  const vec3 cross = glm::cross(columns[1], columns[2]);
  const double det = glm::dot(columns[0], cross);
  const double size = glm::length(columns[0]) * glm::length(columns[1]) * glm::length(columns[2]);
  if (!(std::fabs(det) > 1e-3 * size)) return std::nullopt;
  const vec3 x = vec3(glm::dot(b, cross), glm::dot(columns[0], glm::cross(b, columns[2])),
                      glm::dot(columns[0], glm::cross(columns[1], b))) /
                 det;
  if (!is_finite(x)) return std::nullopt;
  return x;
}

}  // namespace

std::optional<falcon_angles> falcon_angles_at(const vec3& grip_d) noexcept {
  namespace d = falcon_detail;
  falcon_angles angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double u = d::leg_cos[i] * grip_d.x + d::leg_sin[i] * grip_d.y - d::base_radius_m + d::grip_offset_m;
    const double v = -d::leg_sin[i] * grip_d.x + d::leg_cos[i] * grip_d.y + d::sideways_m;
    const double w = grip_d.z;
    const double across2 = d::link_m * d::link_m - v * v;
    if (!(across2 >= 0.0)) return std::nullopt;
    const double reach = d::joint_offsets_m + std::sqrt(across2);
    // A triangle of arm, reach and the way to the arm's axis: the law of cosines.
    const double way2 = u * u + w * w;
    const double cosine = (way2 + d::arm_m * d::arm_m - reach * reach) / (2.0 * d::arm_m * std::sqrt(way2));
    if (!(cosine >= -1.0 && cosine <= 1.0)) return std::nullopt;
    angles[i] = std::atan2(w, u) - std::acos(cosine);
  }
  return angles;
}

falcon_position falcon_position_at(const falcon_angles& angles, const vec3& start_d) noexcept {
  namespace d = falcon_detail;
  constexpr int most_steps = 15;
  constexpr double longest_step_m = 0.02;
  constexpr double close_enough_m = 1e-9;
  falcon_position found{.grip_d = start_d};
  for (const double angle : angles) {
    if (!std::isfinite(angle)) return found;
  }
  if (!is_finite(start_d)) return found;
  for (; found.iterations < most_steps; ++found.iterations) {
    mat3 transposed;
    vec3 miss;
    for (std::size_t i = 0; i < 3; ++i) {
      const d::leg_state leg = d::look_at_leg(i, found.grip_d, angles[i]);
      const int k = static_cast<int>(i);
      miss[k] = leg.miss_m2;
      for (int j = 0; j < 3; ++j) transposed[j][k] = leg.by_position[j];
    }
    const std::optional<vec3> step = solve_columns(transposed, -miss);
    if (!step) return found;
    const double length = glm::length(*step);
    found.grip_d += length > longest_step_m ? (longest_step_m / length) * *step : *step;
    if (length < close_enough_m) {
      found.converged = true;
      return found;
    }
  }
  return found;
}

std::optional<mat3> falcon_angle_gradients(const vec3& grip_d, const falcon_angles& angles) noexcept {
  mat3 gradients;
  for (std::size_t i = 0; i < 3; ++i) {
    const falcon_detail::leg_state leg = falcon_detail::look_at_leg(i, grip_d, angles[i]);
    if (!(std::fabs(leg.by_angle) > 1e-6)) return std::nullopt;
    gradients[static_cast<int>(i)] = (-1.0 / leg.by_angle) * leg.by_position;
  }
  return gradients;
}

std::optional<vec3> falcon_torques(const vec3& grip_d, const falcon_angles& angles, const vec3& force_d) noexcept {
  const std::optional<mat3> gradients = falcon_angle_gradients(grip_d, angles);
  if (!gradients) return std::nullopt;
  return solve_columns(*gradients, force_d);
}

}  // namespace asperity
