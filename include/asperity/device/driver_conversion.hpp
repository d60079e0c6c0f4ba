// Between the structs of driver_abi.h and the types of this library, for both sides of the border.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

#include "asperity/core/status.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/device/command.hpp"
#include "asperity/device/device_state.hpp"
#include "asperity/device/driver_abi.h"
#include "asperity/device/sample.hpp"

namespace asperity::abi {

static_assert(ASPERITY_STATE_ABSENT == static_cast<int>(device_state::absent));
static_assert(ASPERITY_STATE_PRESENT == static_cast<int>(device_state::present));
static_assert(ASPERITY_STATE_OPEN == static_cast<int>(device_state::open));
static_assert(ASPERITY_STATE_READY == static_cast<int>(device_state::ready));
static_assert(ASPERITY_STATE_ARMED == static_cast<int>(device_state::armed));
static_assert(ASPERITY_STATE_ACTIVE == static_cast<int>(device_state::active));
static_assert(ASPERITY_STATE_FAULT == static_cast<int>(device_state::fault));
static_assert(ASPERITY_STATE_CLOSED == static_cast<int>(device_state::closed));

/// A struct of the interface, zero but for its size, ready to be filled in by the other side.
/// @rt safe
template <class Struct>
[[nodiscard]] Struct blank() noexcept {
  Struct s{};
  s.struct_size = sizeof(Struct);
  return s;
}

/// Writes `from` into a struct of the other side, whose version may be older or newer: never beyond its struct_size,
/// which stays. @rt safe
template <class Struct>
void copy_out(const Struct& from, Struct& to) noexcept {
  static_assert(std::is_trivially_copyable_v<Struct>);
  constexpr std::size_t first = sizeof(std::uint32_t);
  const std::size_t size = std::min<std::size_t>(to.struct_size, sizeof(Struct));
  if (size <= first) return;
  std::memcpy(reinterpret_cast<std::byte*>(&to) + first, reinterpret_cast<const std::byte*>(&from) + first,
              size - first);
}

/// What this side knows of a struct of the other side; what the other side does not know is zero. struct_size is how
/// much came. @rt safe
template <class Struct>
[[nodiscard]] Struct copy_in(const Struct& from) noexcept {
  static_assert(std::is_trivially_copyable_v<Struct>);
  Struct s{};
  const std::size_t size = std::min<std::size_t>(from.struct_size, sizeof(Struct));
  std::memcpy(&s, &from, size);
  s.struct_size = static_cast<std::uint32_t>(size);
  return s;
}

/// Copies text into a fixed field, cut at a character's border, zero bytes after it.
inline void put_text(std::span<char> field, std::string_view text) noexcept {
  if (field.empty()) return;
  std::size_t n = std::min(text.size(), field.size() - 1);
  if (n < text.size()) {
    while (n > 0 && (static_cast<unsigned char>(text[n]) & 0xc0U) == 0x80U) --n;
  }
  std::memset(field.data(), 0, field.size());
  if (n > 0) std::memcpy(field.data(), text.data(), n);
}

/// The text of a fixed field, or nothing where no zero byte ends it.
[[nodiscard]] inline std::optional<std::string_view> get_text(std::span<const char> field) noexcept {
  const auto end = std::find(field.begin(), field.end(), '\0');
  if (end == field.end()) return std::nullopt;
  return std::string_view(field.data(), static_cast<std::size_t>(end - field.begin()));
}

/// @rt safe
[[nodiscard]] constexpr std::int32_t to_code(status s) noexcept {
  switch (s) {
    case status::ok:
    case status::capacity_reached:
      return ASPERITY_OK;
    case status::invalid_pose:
    case status::not_finite:
      return ASPERITY_NOT_FINITE;
    case status::stale_input:
      return ASPERITY_STALE;
    case status::not_ready:
      return ASPERITY_NOT_READY;
    case status::backend_failed:
    case status::gate_shut:
      break;
  }
  return ASPERITY_FAILED;
}

/// @rt safe
[[nodiscard]] constexpr status to_status(std::int32_t code) noexcept {
  switch (code) {
    case ASPERITY_OK:
      return status::ok;
    case ASPERITY_NOT_READY:
      return status::not_ready;
    case ASPERITY_NOT_FINITE:
      return status::not_finite;
    case ASPERITY_STALE:
      return status::stale_input;
    default:
      return status::backend_failed;
  }
}

/// The state, or nothing where the number is none. @rt safe
[[nodiscard]] constexpr std::optional<device_state> to_state(std::int32_t state) noexcept {
  if (state < ASPERITY_STATE_ABSENT || state > ASPERITY_STATE_CLOSED) return std::nullopt;
  return static_cast<device_state>(state);
}

namespace detail {

inline void put(const vec3& from, double (&to)[3]) noexcept {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}
[[nodiscard]] inline vec3 get(const double (&from)[3]) noexcept { return {from[0], from[1], from[2]}; }

}  // namespace detail

[[nodiscard]] inline asperity_capabilities to_abi(const device_capabilities& c) noexcept {
  auto out = blank<asperity_capabilities>();
  out.maturity = static_cast<std::uint32_t>(c.maturity);
  out.sensed = c.sensed;
  out.actuated = c.actuated;
  out.flags =
      (c.needs_homing ? ASPERITY_NEEDS_HOMING : 0U) | (c.device_side_watchdog ? ASPERITY_DEVICE_SIDE_WATCHDOG : 0U);
  out.continuous_force_n = c.continuous_force_n;
  out.peak_force_n = c.peak_force_n;
  out.continuous_torque_n_m = c.continuous_torque_n_m;
  out.peak_torque_n_m = c.peak_torque_n_m;
  out.force_slew_n_per_s = c.force_slew_n_per_s;
  out.torque_slew_n_m_per_s = c.torque_slew_n_m_per_s;
  out.max_stiffness_n_per_m = c.max_stiffness_n_per_m;
  out.max_stiffness_n_m_per_rad = c.max_stiffness_n_m_per_rad;
  out.max_stiffness_rate_hz = c.max_stiffness_rate_hz;
  detail::put(c.workspace_low_d, out.workspace_low_d_m);
  detail::put(c.workspace_high_d, out.workspace_high_d_m);
  out.position_resolution_m = c.position_resolution_m;
  out.rotation_resolution_rad = c.rotation_resolution_rad;
  out.nominal_rate_hz = c.nominal_rate_hz;
  out.minimum_rate_hz = c.minimum_rate_hz;
  out.worst_latency_ns = c.worst_latency_ns;
  out.moving_mass_kg = c.moving_mass_kg;
  out.moving_inertia_kg_m2 = c.moving_inertia_kg_m2;
  put_text(out.name, c.name);
  return out;
}

/// @pre the name in `c` is ended by a zero byte, and `c` outlives the result, whose name points into it
[[nodiscard]] inline device_capabilities from_abi(const asperity_capabilities& c) noexcept {
  return {.name = get_text(c.name).value_or(std::string_view{}),
          .maturity = static_cast<driver_maturity>(c.maturity),
          .sensed = static_cast<axis_mask>(c.sensed),
          .actuated = static_cast<axis_mask>(c.actuated),
          .continuous_force_n = c.continuous_force_n,
          .peak_force_n = c.peak_force_n,
          .continuous_torque_n_m = c.continuous_torque_n_m,
          .peak_torque_n_m = c.peak_torque_n_m,
          .force_slew_n_per_s = c.force_slew_n_per_s,
          .torque_slew_n_m_per_s = c.torque_slew_n_m_per_s,
          .max_stiffness_n_per_m = c.max_stiffness_n_per_m,
          .max_stiffness_n_m_per_rad = c.max_stiffness_n_m_per_rad,
          .max_stiffness_rate_hz = c.max_stiffness_rate_hz,
          .workspace_low_d = detail::get(c.workspace_low_d_m),
          .workspace_high_d = detail::get(c.workspace_high_d_m),
          .position_resolution_m = c.position_resolution_m,
          .rotation_resolution_rad = c.rotation_resolution_rad,
          .nominal_rate_hz = c.nominal_rate_hz,
          .minimum_rate_hz = c.minimum_rate_hz,
          .worst_latency_ns = c.worst_latency_ns,
          .moving_mass_kg = c.moving_mass_kg,
          .moving_inertia_kg_m2 = c.moving_inertia_kg_m2,
          .needs_homing = (c.flags & ASPERITY_NEEDS_HOMING) != 0,
          .device_side_watchdog = (c.flags & ASPERITY_DEVICE_SIDE_WATCHDOG) != 0};
}

/// @rt safe
[[nodiscard]] inline asperity_sample to_abi(const device_sample& s) noexcept {
  auto out = blank<asperity_sample>();
  out.valid = static_cast<std::uint32_t>(s.valid);
  out.host_time_ns = s.host_time_ns;
  out.device_time_ns = s.device_time_ns;
  out.sequence = s.sequence;
  out.lost = s.lost;
  detail::put(s.T_dh.position, out.position_d_m);
  const quat& q = s.T_dh.rotation;
  out.rotation_dh_xyzw[0] = q.x;
  out.rotation_dh_xyzw[1] = q.y;
  out.rotation_dh_xyzw[2] = q.z;
  out.rotation_dh_xyzw[3] = q.w;
  detail::put(s.velocity_d.linear, out.linear_velocity_d_m_per_s);
  detail::put(s.velocity_d.angular, out.angular_velocity_d_rad_per_s);
  out.buttons = s.buttons;
  return out;
}

/// @rt safe
[[nodiscard]] inline device_sample from_abi(const asperity_sample& s) noexcept {
  const auto& q = s.rotation_dh_xyzw;
  return {.host_time_ns = s.host_time_ns,
          .device_time_ns = s.device_time_ns,
          .sequence = s.sequence,
          .lost = s.lost,
          .T_dh = {quat_from_xyzw({q[0], q[1], q[2], q[3]}), detail::get(s.position_d_m)},
          .velocity_d = {detail::get(s.linear_velocity_d_m_per_s), detail::get(s.angular_velocity_d_rad_per_s)},
          .buttons = s.buttons,
          .valid = static_cast<sample_field>(s.valid & 0x1fU)};
}

/// @rt safe
[[nodiscard]] inline asperity_command to_abi(const device_command& c) noexcept {
  auto out = blank<asperity_command>();
  out.frame = c.frame == wrench_frame::device_base ? ASPERITY_FRAME_BASE : 0U;
  detail::put(c.on_hand.force, out.force_d_n);
  detail::put(c.on_hand.torque, out.torque_d_n_m);
  out.valid_until_ns = c.valid_until_ns;
  out.sequence = c.sequence;
  return out;
}

/// @rt safe
[[nodiscard]] inline device_command from_abi(const asperity_command& c) noexcept {
  return {.on_hand = {detail::get(c.force_d_n), detail::get(c.torque_d_n_m)},
          .frame = c.frame == ASPERITY_FRAME_BASE ? wrench_frame::device_base : wrench_frame::unset,
          .valid_until_ns = c.valid_until_ns,
          .sequence = c.sequence};
}

/// @rt safe
[[nodiscard]] inline asperity_applied to_abi(const wrench& w) noexcept {
  auto out = blank<asperity_applied>();
  detail::put(w.force, out.force_d_n);
  detail::put(w.torque, out.torque_d_n_m);
  return out;
}

/// @rt safe
[[nodiscard]] inline wrench from_abi(const asperity_applied& a) noexcept {
  return {detail::get(a.force_d_n), detail::get(a.torque_d_n_m)};
}

}  // namespace asperity::abi
