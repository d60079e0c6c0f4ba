// The motors of a simulated device: what they can follow, and how warm they get.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "asperity/core/spatial.hpp"
#include "asperity/device/gate_function.hpp"

namespace asperity {

/// Limits of the motors themselves, which hold whatever a host sends. The defaults are none: the motors put out what
/// they are commanded, at once.
struct actuator_settings {
  static constexpr double none = std::numeric_limits<double>::infinity();
  double peak_force_n = none;
  double peak_torque_n_m = none;
  double force_slew_n_per_s = none;
  double torque_slew_n_m_per_s = none;

  /// One winding, heated by the square of the force and cooled by the air: a temperature of 1 is what the continuous
  /// force settles to. Infinite: it stays cold.
  double continuous_force_n = none;
  double thermal_time_s = 20.0;
  double derate_from = 1.0;  ///< temperature above which the peak falls ...
  double burns_at = 2.0;     ///< ... to zero here, where the device reports a fault
};

/// Follows commands as far as its limits let it.
/// @rt safe
class simulated_actuator {
 public:
  explicit simulated_actuator(const actuator_settings& settings = {}) noexcept
      : settings_(settings),
        limited_(settings.peak_force_n < none || settings.peak_torque_n_m < none ||
                 settings.force_slew_n_per_s < none || settings.torque_slew_n_m_per_s < none ||
                 settings.continuous_force_n < none) {}

  /// What the motors put out over the next h seconds.
  [[nodiscard]] wrench follow(const wrench& commanded, double h) noexcept {
    if (!limited_) return commanded;
    const double left =
        std::clamp((settings_.burns_at - warmth_) / (settings_.burns_at - settings_.derate_from), 0.0, 1.0);
    out_ = {
        bounded(commanded.force, out_.force, settings_.peak_force_n, left, settings_.force_slew_n_per_s * h),
        bounded(commanded.torque, out_.torque, settings_.peak_torque_n_m, left, settings_.torque_slew_n_m_per_s * h)};
    const double share =
        glm::dot(out_.force, out_.force) / (settings_.continuous_force_n * settings_.continuous_force_n);
    warmth_ += h / settings_.thermal_time_s * (share - warmth_);
    return out_;
  }

  /// Temperature above the air's, in that of the continuous force held for ever.
  [[nodiscard]] double warmth() const noexcept { return warmth_; }
  [[nodiscard]] bool burnt() const noexcept { return warmth_ >= settings_.burns_at; }

 private:
  static constexpr double none = actuator_settings::none;
  static constexpr double most = 1e6;  // N or N m: bound_vector's largest limit stands for none

  [[nodiscard]] static vec3 bounded(const vec3& commanded, const vec3& before, double peak, double left,
                                    double change) noexcept {
    const double limit = std::min(peak, most);
    return bound_vector(commanded, before, {limit, left * limit, change}, true).value;
  }

  actuator_settings settings_;
  bool limited_;
  double warmth_ = 0.0;
  wrench out_{};
};

}  // namespace asperity
