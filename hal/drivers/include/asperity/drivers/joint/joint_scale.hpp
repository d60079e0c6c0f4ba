// Conversion between a drive's shaft and its joint.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/drivers/joint/wire_number.hpp"

namespace asperity {

/// A gear, a direction and a zero between the shaft that a drive speaks of and the joint. No losses: a torque of the
/// joint is the shaft's times the ratio.
struct joint_scale {
  double gear_ratio = 1.0;  ///< turns of the drive's shaft per turn of the joint
  bool reversed = false;    ///< the joint turns against the shaft
  double zero_rad = 0.0;    ///< angle of the joint where the drive reports 0

  [[nodiscard]] bool usable() const noexcept {
    return std::isfinite(gear_ratio) && gear_ratio > 1e-3 && gear_ratio < 1e6 && std::isfinite(zero_rad);
  }
  [[nodiscard]] constexpr double sign() const noexcept { return reversed ? -1.0 : 1.0; }
  /// Angle of the joint, rad.
  [[nodiscard]] constexpr double angle(double shaft_rad) const noexcept {
    return sign() * shaft_rad / gear_ratio + zero_rad;
  }
  [[nodiscard]] constexpr double velocity(double shaft_rad_per_s) const noexcept {
    return sign() * shaft_rad_per_s / gear_ratio;
  }
  /// Torque of the joint, N m.
  [[nodiscard]] constexpr double torque(double shaft_n_m) const noexcept { return sign() * shaft_n_m * gear_ratio; }
  /// Torque of the shaft, N m.
  [[nodiscard]] constexpr double shaft_torque(double joint_n_m) const noexcept {
    return sign() * joint_n_m / gear_ratio;
  }
  /// The largest float to command to the shaft such that the joint's torque stays within `peak_n_m` after rounding.
  [[nodiscard]] float shaft_limit(double peak_n_m) const noexcept {
    float limit = float_toward_zero(std::max(peak_n_m, 0.0) / gear_ratio);
    while (static_cast<double>(limit) * gear_ratio > peak_n_m && limit > 0.0F) limit = std::nextafter(limit, 0.0F);
    return limit;
  }
};

}  // namespace asperity
