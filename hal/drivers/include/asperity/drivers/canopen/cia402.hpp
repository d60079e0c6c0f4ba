// CiA 402 in cyclic synchronous torque mode: status word, control word, process data, and torque as an integer.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "asperity/drivers/canopen/frames.hpp"

namespace asperity::canopen {

/// States of a drive's power section.
enum class power_state : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop,
  fault_reaction,
  fault,
  unknown,  ///< a status word that belongs to no state
};

[[nodiscard]] constexpr const char* to_string(power_state s) noexcept {
  switch (s) {
    case power_state::not_ready:
      return "not ready to switch on";
    case power_state::switch_on_disabled:
      return "switch on disabled";
    case power_state::ready_to_switch_on:
      return "ready to switch on";
    case power_state::switched_on:
      return "switched on";
    case power_state::operation_enabled:
      return "operation enabled";
    case power_state::quick_stop:
      return "quick stop active";
    case power_state::fault_reaction:
      return "fault reaction active";
    case power_state::fault:
      return "fault";
    case power_state::unknown:
      return "unknown";
  }
  return "unknown";
}

/// State in object 6041.
[[nodiscard]] constexpr power_state decode_status(std::uint16_t word) noexcept {
  switch (word & 0x4f) {  // bits 0-3 and 6: these states leave bit 5 open
    case 0x00:
      return power_state::not_ready;
    case 0x40:
      return power_state::switch_on_disabled;
    case 0x0f:
      return power_state::fault_reaction;
    case 0x08:
      return power_state::fault;
    default:
      break;
  }
  switch (word & 0x6f) {
    case 0x21:
      return power_state::ready_to_switch_on;
    case 0x23:
      return power_state::switched_on;
    case 0x27:
      return power_state::operation_enabled;
    case 0x07:
      return power_state::quick_stop;
    default:
      return power_state::unknown;
  }
}

/// Values of object 6040.
namespace control {
inline constexpr std::uint16_t disable_voltage = 0x0000;
inline constexpr std::uint16_t quick_stop = 0x0002;
inline constexpr std::uint16_t shutdown = 0x0006;
inline constexpr std::uint16_t switch_on = 0x0007;
inline constexpr std::uint16_t enable_operation = 0x000f;
inline constexpr std::uint16_t fault_reset = 0x0080;  ///< works where bit 7 rises
}  // namespace control

inline constexpr std::int8_t torque_mode = 10;                 ///< cyclic synchronous torque, object 6060
inline constexpr std::uint32_t torque_mode_supported = 0x200;  ///< its bit in object 6502

/// Target torque of object 6071 in thousandths of the rated torque: rounded towards zero, saturated, NaN is 0.
/// The torque that the answer stands for never has the other sign and is never larger than asked.
/// @param rated_n_m object 6076; not above 0 gives 0
/// @param limit_permille largest magnitude, 0 to 32767
/// @rt safe
[[nodiscard]] constexpr std::int16_t encode_torque(double torque_n_m, double rated_n_m,
                                                   std::int16_t limit_permille) noexcept {
  if (!(rated_n_m > 0.0) || limit_permille <= 0) return 0;
  const double permille = torque_n_m / rated_n_m * 1000.0;
  if (permille >= limit_permille) return limit_permille;
  if (permille <= -limit_permille) return static_cast<std::int16_t>(-limit_permille);
  if (!(permille > -limit_permille)) return 0;  // NaN
  int whole = static_cast<int>(permille);
  // The division may have rounded up to a whole number.
  if (whole > 0 && whole * rated_n_m / 1000.0 > torque_n_m) --whole;
  if (whole < 0 && whole * rated_n_m / 1000.0 < torque_n_m) ++whole;
  return static_cast<std::int16_t>(whole);
}

/// @rt safe
[[nodiscard]] constexpr double decode_torque(std::int16_t permille, double rated_n_m) noexcept {
  return permille * rated_n_m / 1000.0;
}

/// To the drive: RPDO1 = 6040, 6060, 6071.
struct torque_command {
  std::uint16_t control_word = control::disable_voltage;
  std::int8_t mode = torque_mode;
  std::int16_t torque_permille = 0;
  friend bool operator==(const torque_command&, const torque_command&) = default;
};
[[nodiscard]] constexpr can_frame encode(std::uint8_t node, const torque_command& c) noexcept {
  can_frame f = empty_frame(rpdo1_id + node, 5);
  put(f, 0, c.control_word);
  f.data[2] = static_cast<std::uint8_t>(c.mode);
  put(f, 3, static_cast<std::uint16_t>(c.torque_permille));
  return f;
}
[[nodiscard]] constexpr std::optional<torque_command> decode_command(const can_frame& f, std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != rpdo1_id + node || f.size != 5) return std::nullopt;
  return torque_command{get<std::uint16_t>(f, 0), static_cast<std::int8_t>(f.data[2]),
                        static_cast<std::int16_t>(get<std::uint16_t>(f, 3))};
}

/// From the drive: TPDO1 = 6041, 6061, 6077.
struct torque_status {
  std::uint16_t status_word = 0;
  std::int8_t mode = 0;
  std::int16_t torque_permille = 0;
  friend bool operator==(const torque_status&, const torque_status&) = default;
};
[[nodiscard]] constexpr can_frame encode(std::uint8_t node, const torque_status& s) noexcept {
  can_frame f = empty_frame(tpdo1_id + node, 5);
  put(f, 0, s.status_word);
  f.data[2] = static_cast<std::uint8_t>(s.mode);
  put(f, 3, static_cast<std::uint16_t>(s.torque_permille));
  return f;
}
[[nodiscard]] constexpr std::optional<torque_status> decode_status_frame(const can_frame& f,
                                                                         std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != tpdo1_id + node || f.size != 5) return std::nullopt;
  return torque_status{get<std::uint16_t>(f, 0), static_cast<std::int8_t>(f.data[2]),
                       static_cast<std::int16_t>(get<std::uint16_t>(f, 3))};
}

/// From the drive: TPDO2 = 6064, 606C.
struct motion_counts {
  std::int32_t position = 0;
  std::int32_t velocity_per_s = 0;
  friend bool operator==(const motion_counts&, const motion_counts&) = default;
};
[[nodiscard]] constexpr can_frame encode(std::uint8_t node, const motion_counts& m) noexcept {
  can_frame f = empty_frame(tpdo2_id + node, 8);
  put(f, 0, static_cast<std::uint32_t>(m.position));
  put(f, 4, static_cast<std::uint32_t>(m.velocity_per_s));
  return f;
}
[[nodiscard]] constexpr std::optional<motion_counts> decode_motion_frame(const can_frame& f,
                                                                         std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != tpdo2_id + node || f.size != 8) return std::nullopt;
  return motion_counts{static_cast<std::int32_t>(get<std::uint32_t>(f, 0)),
                       static_cast<std::int32_t>(get<std::uint32_t>(f, 4))};
}

}  // namespace asperity::canopen
