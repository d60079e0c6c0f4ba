// What a device reports, and what it is told.
#pragma once

#include <cstdint>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// Which fields of a device_sample the device really measured.
enum class sample_field : std::uint8_t {
  none = 0,
  position = 1,
  rotation = 2,
  linear_velocity = 4,
  angular_velocity = 8,
  buttons = 16,
  gripper = 32,
};

[[nodiscard]] constexpr sample_field operator|(sample_field a, sample_field b) noexcept {
  return static_cast<sample_field>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
[[nodiscard]] constexpr sample_field without(sample_field set, sample_field bits) noexcept {
  return static_cast<sample_field>(static_cast<std::uint8_t>(set) & ~static_cast<std::uint8_t>(bits));
}
/// True where every bit of `bits` is in `set`.
[[nodiscard]] constexpr bool has_all(sample_field set, sample_field bits) noexcept {
  return (static_cast<std::uint8_t>(set) & static_cast<std::uint8_t>(bits)) == static_cast<std::uint8_t>(bits);
}

/// One measurement of a device: where its handle is, and when.
/// A device that lacks an axis reports the constant value of that axis and leaves the field's bit unset.
struct device_sample {
  std::int64_t host_time_ns = 0;    ///< when the host received it, on the clock of the session
  std::int64_t device_time_ns = 0;  ///< when the device measured it, on the device's own clock
  std::uint64_t sequence = 0;       ///< grows by one with every new measurement; equal means nothing new came
  std::uint64_t lost = 0;           ///< measurements that the transport is known to have lost so far
  pose T_dh{};                      ///< handle h in the device's base frame d, metres
  twist velocity_d{};               ///< of the handle's origin, base frame, m/s and rad/s
  std::uint32_t buttons = 0;        ///< one bit per button, pressed = 1
  sample_field valid = sample_field::none;
  double gripper_m = 0.0;  ///< opening of a gripper on the handle, m: the seventh axis of a device that has one
};

/// The frame that a command's wrench is written in. There is one right answer for a device; the tag is carried so that
/// a wrong one is found by the gate and not by a hand.
enum class wrench_frame : std::uint8_t {
  unset,
  device_base,  ///< axes of d, torque about the handle's origin: the only frame that a device takes
  world,        ///< axes of w
  handle,       ///< axes of h
};

/// The wrench that a device shall put on the hand.
struct device_command {
  wrench on_hand{};  ///< N and N m
  wrench_frame frame = wrench_frame::unset;
  std::int64_t valid_until_ns = 0;  ///< a device applies zero after this time (session clock)
  std::uint64_t sequence = 0;       ///< grows by one with every command
};

}  // namespace asperity
