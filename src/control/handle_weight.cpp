#include <cmath>
#include <string>

#include "asperity/control/passivity_guard.hpp"

namespace asperity {
namespace {

constexpr double part_of_the_device = 0.5;
constexpr double longest_arm_m = 0.5;
constexpr double most_gravity = 20.0;  // m/s^2
constexpr double shortest_ramp_s = 0.05;

bool is_well_formed(const weight_settings& w) noexcept {
  return std::isfinite(w.mass_kg) && w.mass_kg >= 0.0 && is_finite(w.centre_h) && is_finite(w.gravity_d) &&
         glm::length(w.centre_h) <= longest_arm_m && glm::length(w.gravity_d) <= most_gravity &&
         w.ramp_s >= shortest_ramp_s && std::isfinite(w.ramp_s);
}

double weight_n(const weight_settings& w) noexcept { return w.mass_kg * glm::length(w.gravity_d); }

bool can_lift(const weight_settings& w, const device_capabilities& device) noexcept {
  return weight_n(w) <= part_of_the_device * device.continuous_force_n;
}

bool can_balance(const weight_settings& w, const device_capabilities& device) noexcept {
  return !(device.continuous_torque_n_m > 0.0) ||
         weight_n(w) * glm::length(w.centre_h) <= part_of_the_device * device.continuous_torque_n_m;
}

}  // namespace

result<void> check(const weight_settings& w, const device_capabilities& device) {
  if (!w.any()) return {};
  if (!is_well_formed(w)) {
    return error{error_code::invalid_argument,
                 "the weight of the handle is none: a mass of 0 kg or more, its centre within 0.5 m of the handle's "
                 "origin, a gravity of 20 m/s^2 or less and a ramp of 0.05 s or more are"};
  }
  if (!can_lift(w, device)) {
    return error{error_code::invalid_argument,
                 "a handle of " + std::to_string(weight_n(w)) + " N is more than half of the " +
                     std::to_string(device.continuous_force_n) +
                     " N that the device can hold for ever: state a smaller mass, or balance the handle"};
  }
  if (!can_balance(w, device)) {
    return error{error_code::invalid_argument,
                 "the handle's centre of mass is so far from its origin that its moment is more than half of the " +
                     std::to_string(device.continuous_torque_n_m) +
                     " N m that the device can hold for ever: state a nearer centre, or balance the handle"};
  }
  return {};
}

bool handle_weight::is_within(const weight_settings& w, const device_capabilities& device) noexcept {
  return is_well_formed(w) && can_lift(w, device) && can_balance(w, device);
}

}  // namespace asperity
