#include "asperity/device/driver_conversion.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

namespace asperity::abi {
namespace {

void put(const vec3& from, double (&to)[3]) noexcept {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}
constexpr std::uint32_t known_fields = 0x3fU;

vec3 get(const double (&from)[3]) noexcept { return {from[0], from[1], from[2]}; }

}  // namespace

void put_text(std::span<char> field, std::string_view text) noexcept {
  if (field.empty()) return;
  std::size_t n = std::min(text.size(), field.size() - 1);
  if (n < text.size()) {
    while (n > 0 && (static_cast<unsigned char>(text[n]) & 0xc0U) == 0x80U) --n;
  }
  std::memset(field.data(), 0, field.size());
  if (n > 0) std::memcpy(field.data(), text.data(), n);
}

std::optional<std::string_view> get_text(std::span<const char> field) noexcept {
  const auto end = std::find(field.begin(), field.end(), '\0');
  if (end == field.end()) return std::nullopt;
  return std::string_view(field.data(), static_cast<std::size_t>(end - field.begin()));
}

asperity_capabilities to_abi(const device_capabilities& c) noexcept {
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
  put(c.workspace_low_d, out.workspace_low_d_m);
  put(c.workspace_high_d, out.workspace_high_d_m);
  out.position_resolution_m = c.position_resolution_m;
  out.rotation_resolution_rad = c.rotation_resolution_rad;
  out.nominal_rate_hz = c.nominal_rate_hz;
  out.minimum_rate_hz = c.minimum_rate_hz;
  out.worst_latency_ns = c.worst_latency_ns;
  out.moving_mass_kg = c.moving_mass_kg;
  out.moving_inertia_kg_m2 = c.moving_inertia_kg_m2;
  put_text(out.name, c.name);
  out.gripper_low_m = c.gripper_low_m;
  out.gripper_high_m = c.gripper_high_m;
  return out;
}

device_capabilities from_abi(const asperity_capabilities& c) noexcept {
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
          .workspace_low_d = get(c.workspace_low_d_m),
          .workspace_high_d = get(c.workspace_high_d_m),
          .position_resolution_m = c.position_resolution_m,
          .rotation_resolution_rad = c.rotation_resolution_rad,
          .nominal_rate_hz = c.nominal_rate_hz,
          .minimum_rate_hz = c.minimum_rate_hz,
          .worst_latency_ns = c.worst_latency_ns,
          .moving_mass_kg = c.moving_mass_kg,
          .moving_inertia_kg_m2 = c.moving_inertia_kg_m2,
          .needs_homing = (c.flags & ASPERITY_NEEDS_HOMING) != 0,
          .device_side_watchdog = (c.flags & ASPERITY_DEVICE_SIDE_WATCHDOG) != 0,
          .gripper_low_m = c.gripper_low_m,
          .gripper_high_m = c.gripper_high_m};
}

asperity_sample to_abi(const device_sample& s) noexcept {
  auto out = blank<asperity_sample>();
  out.valid = static_cast<std::uint32_t>(s.valid);
  out.host_time_ns = s.host_time_ns;
  out.device_time_ns = s.device_time_ns;
  out.sequence = s.sequence;
  out.lost = s.lost;
  put(s.T_dh.position, out.position_d_m);
  const quat& q = s.T_dh.rotation;
  out.rotation_dh_xyzw[0] = q.x;
  out.rotation_dh_xyzw[1] = q.y;
  out.rotation_dh_xyzw[2] = q.z;
  out.rotation_dh_xyzw[3] = q.w;
  put(s.velocity_d.linear, out.linear_velocity_d_m_per_s);
  put(s.velocity_d.angular, out.angular_velocity_d_rad_per_s);
  out.buttons = s.buttons;
  out.gripper_m = s.gripper_m;
  return out;
}

device_sample from_abi(const asperity_sample& s) noexcept {
  const auto& q = s.rotation_dh_xyzw;
  return {.host_time_ns = s.host_time_ns,
          .device_time_ns = s.device_time_ns,
          .sequence = s.sequence,
          .lost = s.lost,
          .T_dh = {quat_from_xyzw({q[0], q[1], q[2], q[3]}), get(s.position_d_m)},
          .velocity_d = {get(s.linear_velocity_d_m_per_s), get(s.angular_velocity_d_rad_per_s)},
          .buttons = s.buttons,
          .valid = static_cast<sample_field>(s.valid & known_fields),
          .gripper_m = s.gripper_m};
}

asperity_command to_abi(const device_command& c) noexcept {
  auto out = blank<asperity_command>();
  out.frame = c.frame == wrench_frame::device_base ? ASPERITY_FRAME_BASE : 0U;
  put(c.on_hand.force, out.force_d_n);
  put(c.on_hand.torque, out.torque_d_n_m);
  out.valid_until_ns = c.valid_until_ns;
  out.sequence = c.sequence;
  return out;
}

device_command from_abi(const asperity_command& c) noexcept {
  return {.on_hand = {get(c.force_d_n), get(c.torque_d_n_m)},
          .frame = c.frame == ASPERITY_FRAME_BASE ? wrench_frame::device_base : wrench_frame::unset,
          .valid_until_ns = c.valid_until_ns,
          .sequence = c.sequence};
}

asperity_applied to_abi(const wrench& w) noexcept {
  auto out = blank<asperity_applied>();
  put(w.force, out.force_d_n);
  put(w.torque, out.torque_d_n_m);
  return out;
}

wrench from_abi(const asperity_applied& a) noexcept { return {get(a.force_d_n), get(a.torque_d_n_m)}; }

}  // namespace asperity::abi
