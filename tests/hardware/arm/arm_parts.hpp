// The parts of a six-joint arm, for tests that put it together on different buses.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "asperity/drivers/articulated/articulated_settings.hpp"
#include "asperity/drivers/canopen/cia402_drive.hpp"
#include "hardware/peers/fake_arm.hpp"
#include "hardware/peers/fake_cia402.hpp"

namespace asperity::test_support {

inline constexpr std::size_t arm_joints = 6;
inline constexpr std::size_t arm_buses = 3;
inline constexpr double arm_gear = 10.0;
inline constexpr double arm_counts = 65536.0;

/// Two links of 0.25 m and a wrist; handle 80 mm beyond it. Peak torques of a size that a desk arm has.
[[nodiscard]] inline serial_chain desk_arm() {
  serial_chain c;
  const auto add = [&c](const vec3& at, const vec3& axis, double range, double torque, double mass, const vec3& centre,
                        double inertia) {
    static_cast<void>(c.joints.push_back({.T_parent = {quat(1.0, 0.0, 0.0, 0.0), at},
                                          .axis = axis,
                                          .lower_rad = -range,
                                          .upper_rad = range,
                                          .max_torque_n_m = torque,
                                          .link = {mass, centre, mat3(inertia)}}));
  };
  add({0.0, 0.0, 0.1}, {0, 0, 1}, 2.5, 12.0, 0.4, {0.0, 0.0, 0.05}, 4e-4);
  add({0.0, 0.0, 0.1}, {0, 1, 0}, 2.0, 12.0, 0.6, {0.1, 0.0, 0.0}, 1.5e-3);
  add({0.25, 0.0, 0.0}, {0, 1, 0}, 2.6, 12.0, 0.4, {0.1, 0.0, 0.0}, 1e-3);
  add({0.25, 0.0, 0.0}, {1, 0, 0}, 2.8, 3.0, 0.1, {0.0, 0.0, 0.0}, 1e-4);
  add({0.0, 0.0, 0.0}, {0, 1, 0}, 1.9, 3.0, 0.1, {0.02, 0.0, 0.0}, 1e-4);
  add({0.0, 0.0, 0.0}, {1, 0, 0}, 2.8, 3.0, 0.08, {0.06, 0.0, 0.0}, 5e-5);
  c.T_handle = {quat(1.0, 0.0, 0.0, 0.0), {0.08, 0.0, 0.0}};
  return c;
}

/// Elbow up, handle level: far from every singularity and every limit.
inline constexpr joint_vector arm_start_rad{0.1, -0.9, 1.7, 0.05, -0.7, 0.1};

/// The mechanics, without a hand's motion.
[[nodiscard]] inline fake_arm_settings arm_mechanics() {
  fake_arm_settings c;
  c.chain = desk_arm();
  c.start_rad = arm_start_rad;
  for (std::size_t i = 0; i < arm_joints; ++i) {
    c.reflected_kg_m2[i] = i < 3 ? 5e-3 : 1e-3;
    c.friction_n_m_s_per_rad[i] = i < 3 ? 0.05 : 0.01;
  }
  return c;
}

// Two motors are mounted the other way round, and no encoder is at 0 where its joint is.
[[nodiscard]] inline bool arm_reversed(std::size_t i) { return i == 1 || i == 4; }
[[nodiscard]] inline double arm_zero_rad(std::size_t i) { return 0.1 * static_cast<double>(i); }
[[nodiscard]] inline std::uint32_t arm_rated_m_n_m(std::size_t i) { return i < 3 ? 400 : 150; }
[[nodiscard]] inline std::uint8_t arm_node(std::size_t i) { return static_cast<std::uint8_t>(i + 1); }

/// What the driver is told of motor i; the rest is `base`'s.
[[nodiscard]] inline cia402_settings arm_motor(std::size_t i, cia402_settings base) {
  base.node = arm_node(i);
  base.rated_torque_n_m = 1e-3 * arm_rated_m_n_m(i);
  base.peak_torque_n_m = i < 3 ? 12.0 : 3.0;
  base.counts_per_turn = arm_counts;
  base.gear_ratio = arm_gear;
  base.reversed = arm_reversed(i);
  base.zero_offset_rad = arm_zero_rad(i);
  return base;
}

/// Joint i of the device, on a bus of two joints each.
[[nodiscard]] inline arm_joint arm_joint_of(std::size_t i, joint_drive& drive) {
  return {.drive = &drive,
          .bus = i / 2,
          .continuous_torque_n_m = i < 3 ? 8.0 : 2.0,
          .reflected_inertia_kg_m2 = arm_mechanics().reflected_kg_m2[i]};
}

/// Torque of joint i, N m, as the motor puts it out.
[[nodiscard]] inline double joint_torque(const fake_cia402& motor, std::size_t i) {
  return (arm_reversed(i) ? -1.0 : 1.0) * arm_gear * 1e-3 * arm_rated_m_n_m(i) * motor.torque_permille() / 1000.0;
}

/// What encoder i counts.
inline void move_encoder(fake_cia402& motor, std::size_t i, double angle_rad, double rate_rad_per_s) {
  const double counts_per_rad = (arm_reversed(i) ? -1.0 : 1.0) * arm_counts * arm_gear / (2.0 * std::numbers::pi);
  motor.set_motion(static_cast<std::int32_t>(std::lround((angle_rad - arm_zero_rad(i)) * counts_per_rad)),
                   static_cast<std::int32_t>(std::lround(rate_rad_per_s * counts_per_rad)));
}

}  // namespace asperity::test_support
