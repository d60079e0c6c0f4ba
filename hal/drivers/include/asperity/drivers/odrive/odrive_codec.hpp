// Frames of ODrive's CANSimple, firmware 0.5 and 0.6.
// Source: ODrive's docs/can-protocol (0.5) and the message table of ros_odrive (0.6), both MIT licence.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/wire_number.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity::odrive {

/// The two tables of messages. They share the way to torque; getters and heartbeat differ.
enum class firmware : std::uint8_t {
  v0_5,  ///< getters are asked for with a remote frame; 0x1c is a voltage; heartbeat with flags
  v0_6,  ///< getters come by themselves; 0x1c are torques; heartbeat with the result of a procedure
};

/// Low five bits of an id.
enum class message : std::uint8_t {
  version = 0x00,  ///< 0.6 only
  heartbeat = 0x01,
  estop = 0x02,
  error = 0x03,  ///< 0.5: of the motor, 64 bits
  set_axis_state = 0x07,
  encoder_estimates = 0x09,
  set_controller_mode = 0x0b,
  set_input_torque = 0x0e,
  iq = 0x14,
  clear_errors = 0x18,
  torques = 0x1c,  ///< 0.6 only
};

inline constexpr std::uint32_t most_node = 0x3f;
inline constexpr std::uint8_t axis_idle = 1;
inline constexpr std::uint8_t axis_closed_loop = 8;
inline constexpr std::uint32_t torque_control = 1;
inline constexpr std::uint32_t input_passthrough = 1;

[[nodiscard]] constexpr std::uint32_t frame_id(std::uint32_t node, message m) noexcept {
  return (node & most_node) << 5U | static_cast<std::uint32_t>(m);
}

/// Asks for a message: an empty remote frame, or an empty data frame, which both firmwares take as well.
[[nodiscard]] constexpr can_frame ask(std::uint32_t node, message m, bool remote) noexcept {
  return {.id = frame_id(node, m), .remote = remote};
}

/// Torque of the motor, N m: within +-limit, rounded towards zero; 0 for what is not finite.
[[nodiscard]] constexpr can_frame set_input_torque(std::uint32_t node, double torque_n_m, float limit_n_m) noexcept {
  can_frame f{.id = frame_id(node, message::set_input_torque), .size = 4};
  put_little_float(f.data.data(), wire_float(torque_n_m, limit_n_m));
  return f;
}
[[nodiscard]] constexpr can_frame set_axis_state(std::uint32_t node, std::uint32_t state) noexcept {
  can_frame f{.id = frame_id(node, message::set_axis_state), .size = 4};
  put_little_u32(f.data.data(), state);
  return f;
}
/// Torque control, the input passed through as it is.
[[nodiscard]] constexpr can_frame set_torque_mode(std::uint32_t node) noexcept {
  can_frame f{.id = frame_id(node, message::set_controller_mode), .size = 8};
  put_little_u32(f.data.data(), torque_control);
  put_little_u32(f.data.data() + 4, input_passthrough);
  return f;
}
/// One byte in 0.6, which is the identification light; 0.5 ignores it.
[[nodiscard]] constexpr can_frame clear_errors(std::uint32_t node) noexcept {
  return {.id = frame_id(node, message::clear_errors), .size = 1};
}
[[nodiscard]] constexpr can_frame estop(std::uint32_t node) noexcept { return {.id = frame_id(node, message::estop)}; }

struct heartbeat {
  std::uint32_t axis_error = 0;
  std::uint8_t axis_state = 0;
  std::uint8_t procedure_result = 0;  ///< 0.6
  bool motor_error = false;           ///< 0.5
  bool encoder_error = false;         ///< 0.5
  bool controller_error = false;      ///< 0.5
  bool trajectory_done = false;

  friend bool operator==(const heartbeat&, const heartbeat&) = default;
};

/// @pre f.size == 8
[[nodiscard]] constexpr heartbeat decode_heartbeat(const can_frame& f, firmware v) noexcept {
  heartbeat h{.axis_error = little_u32(f.data.data()), .axis_state = f.data[4]};
  if (v == firmware::v0_6) {
    h.procedure_result = f.data[5];
    h.trajectory_done = (f.data[6] & 1U) != 0;
  } else {
    h.motor_error = (f.data[5] & 1U) != 0;
    h.encoder_error = (f.data[6] & 1U) != 0;
    h.controller_error = (f.data[7] & 1U) != 0;
    h.trajectory_done = (f.data[7] & 0x80U) != 0;
  }
  return h;
}
[[nodiscard]] constexpr can_frame encode_heartbeat(std::uint32_t node, const heartbeat& h, firmware v) noexcept {
  can_frame f{.id = frame_id(node, message::heartbeat), .size = 8};
  put_little_u32(f.data.data(), h.axis_error);
  f.data[4] = h.axis_state;
  if (v == firmware::v0_6) {
    f.data[5] = h.procedure_result;
    f.data[6] = h.trajectory_done ? 1 : 0;
  } else {
    f.data[5] = h.motor_error ? 1 : 0;
    f.data[6] = h.encoder_error ? 1 : 0;
    f.data[7] = static_cast<std::uint8_t>((h.controller_error ? 1U : 0U) | (h.trajectory_done ? 0x80U : 0U));
  }
  return f;
}

/// Two floats, as most getters have: position and velocity in turns (encoder_estimates), set point and measurement in
/// A (iq) or N m (torques).
struct float_pair {
  float first = 0.0F;
  float second = 0.0F;
};
/// @pre f.size == 8
[[nodiscard]] constexpr float_pair decode_floats(const can_frame& f) noexcept {
  return {little_float(f.data.data()), little_float(f.data.data() + 4)};
}
[[nodiscard]] constexpr can_frame encode_floats(std::uint32_t node, message m, float_pair p) noexcept {
  can_frame f{.id = frame_id(node, m), .size = 8};
  put_little_float(f.data.data(), p.first);
  put_little_float(f.data.data() + 4, p.second);
  return f;
}

struct version {
  std::uint8_t protocol = 0;
  std::uint8_t hardware_major = 0, hardware_minor = 0, hardware_variant = 0;
  std::uint8_t major = 0, minor = 0, revision = 0, unreleased = 0;  ///< of the firmware

  friend bool operator==(const version&, const version&) = default;
};
/// @pre f.size == 8
[[nodiscard]] constexpr version decode_version(const can_frame& f) noexcept {
  return {f.data[0], f.data[1], f.data[2], f.data[3], f.data[4], f.data[5], f.data[6], f.data[7]};
}
[[nodiscard]] constexpr can_frame encode_version(std::uint32_t node, const version& v) noexcept {
  can_frame f{.id = frame_id(node, message::version), .size = 8};
  const std::array<std::uint8_t, 8> b{v.protocol, v.hardware_major, v.hardware_minor, v.hardware_variant,
                                      v.major,    v.minor,          v.revision,       v.unreleased};
  for (std::size_t i = 0; i < b.size(); ++i) f.data[i] = b[i];
  return f;
}

/// An error word in words: the meaning of its most specific bit.
[[nodiscard]] ASPERITY_API const char* to_string_error(std::uint32_t error, firmware v) noexcept;

}  // namespace asperity::odrive
