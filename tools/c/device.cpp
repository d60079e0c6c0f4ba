// The simulated device behind a handle.
#include "asperity/c/device.h"

#include <cmath>

#include "asperity/device/simulated/simulated_device.hpp"
#include "c/held_device.hpp"

namespace {

using namespace asperity;
using namespace asperity::c;

vec3 direction_or(const double* given, const vec3& usual) noexcept {
  const vec3 v = vec3_of(given);
  return v == vec3(0.0) ? usual : v;
}

bool is_unit(const vec3& v) noexcept { return std::fabs(glm::dot(v, v) - 1.0) <= 2e-6; }

result<simulated_settings> settings_from(const asperity_simulated_settings& s) {
  simulated_settings out;
  motion_settings& m = out.motion;
  m.kind = s.motion == ASPERITY_MOTION_USUAL ? motion_kind::scrub : static_cast<motion_kind>(s.motion - 1);
  m.T_dh = pose_or(s.start_pose, m.T_dh);
  m.direction_d = direction_or(s.direction, m.direction_d);
  m.sideways_d = direction_or(s.sideways, m.sideways_d);
  m.depth_m = or_usual(s.approach_m, m.depth_m);
  m.approach_s = or_usual(s.approach_s, m.approach_s);
  m.amplitude_m = or_usual(s.amplitude_m, m.amplitude_m);
  m.amplitude_rad = or_usual(s.amplitude_rad, m.amplitude_rad);
  m.frequency_hz = or_usual(s.frequency_hz, m.frequency_hz);
  out.seed = s.seed == 0 ? 1 : s.seed;
  if (s.hand == ASPERITY_HAND_SOFT) out.hand = soft_hand();
  if (s.hand == ASPERITY_HAND_FIRM) out.hand = firm_hand();
  out.measurement.delay_ns = s.delay_ns;
  out.measurement.jitter_ns = s.jitter_ns;
  out.measurement.loss = s.loss;
  constexpr std::int64_t most_ns = 20'000'000;
  const result<void> ok =
      range_check()
          .holds(s.motion <= ASPERITY_MOTION_FREE, "motion is none of ASPERITY_MOTION_...: give 0 to 5")
          .holds(s.hand <= ASPERITY_HAND_FIRM, "hand is none of ASPERITY_HAND_...: give 0 to 2")
          .holds(is_valid(m.T_dh), "start_pose is no pose with a quaternion of unit length: give one, or all zeros")
          .holds(is_unit(m.direction_d), "direction is not of unit length: give a unit vector, or zeros")
          .holds(is_unit(m.sideways_d), "sideways is not of unit length: give a unit vector, or zeros")
          .within("approach_m", m.depth_m, -1.0, 1.0)
          .within("approach_s", m.approach_s, 1e-3, 1e3)
          .within("amplitude_m", m.amplitude_m, 0.0, 1.0)
          .within("amplitude_rad", m.amplitude_rad, 0.0, 3.0)
          .within("frequency_hz", m.frequency_hz, 1e-3, 1e3)
          .holds(s.delay_ns >= 0 && s.jitter_ns >= 0 && s.delay_ns <= most_ns && s.jitter_ns <= most_ns &&
                     s.delay_ns + s.jitter_ns <= most_ns,
                 "delay_ns and jitter_ns are out of range: give 0 to 20000000 together")
          .within("loss", s.loss, 0.0, 1.0)
          .done();
  if (!ok) return ok.error();
  return out;
}

/// The device of a handle that no session has; otherwise null, and why.
held_device* free_device(asperity_haptic_device* given, std::int32_t& code) noexcept {
  code = ASPERITY_ERROR_INVALID_ARGUMENT;
  if (checked(given) == nullptr) return nullptr;
  code = ASPERITY_ERROR_BUSY;
  return given->inside->in_session.load(std::memory_order_acquire) ? nullptr : given->inside.get();
}

std::int32_t refuse_device(asperity_error* why, std::int32_t code) noexcept {
  return refuse(why, code,
                code == ASPERITY_ERROR_BUSY ? "a session has the device: free the session first"
                                            : "device is no device: give a handle of asperity_device_make_simulated()");
}

}  // namespace

std::int32_t asperity_device_make_simulated(const asperity_simulated_settings* settings, asperity_haptic_device** out,
                                            asperity_error* why) {
  return guarded(why, [&] {
    if (out == nullptr) return refuse_argument(why, "out is NULL: give a place for the handle");
    *out = nullptr;
    asperity_simulated_settings s{};
    if (const std::int32_t taken = take(settings, s); taken != ASPERITY_STATUS_OK) return refuse_struct(why, taken);
    result<simulated_settings> wanted = settings_from(s);
    if (!wanted) return refuse(why, wanted.error());
    auto held = std::make_shared<held_device>(any_device(simulated_device(std::move(*wanted))));
    *out = std::make_unique<asperity_haptic_device>(std::move(held)).release();
    return ASPERITY_STATUS_OK;
  });
}

std::int32_t asperity_device_free(asperity_haptic_device* device) {
  if (device == nullptr) return ASPERITY_STATUS_OK;
  if (checked(device) == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  delete device;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_device_open(asperity_haptic_device* device, asperity_error* why) {
  return guarded(why, [&] {
    std::int32_t code = 0;
    held_device* const held = free_device(device, code);
    if (held == nullptr) return refuse_device(why, code);
    const result<void> opened = held->device.open();
    held->keep_state();
    return opened ? ASPERITY_STATUS_OK : refuse(why, opened.error());
  });
}

std::int32_t asperity_device_arm(asperity_haptic_device* device, asperity_error* why) {
  return guarded(why, [&] {
    std::int32_t code = 0;
    held_device* const held = free_device(device, code);
    if (held == nullptr) return refuse_device(why, code);
    const result<void> armed = held->device.arm();
    held->keep_state();
    return armed ? ASPERITY_STATUS_OK : refuse(why, armed.error());
  });
}

std::int32_t asperity_device_disarm(asperity_haptic_device* device) {
  std::int32_t code = 0;
  held_device* const held = free_device(device, code);
  if (held == nullptr) return code;
  const status s = held->device.disarm();
  held->keep_state();
  return answer(s);
}

std::int32_t asperity_device_read(asperity_haptic_device* device, std::int64_t now_ns, asperity_measurement* out) {
  std::int32_t code = 0;
  held_device* const held = free_device(device, code);
  if (held == nullptr) return code;
  // The simulated device lives every moment up to now.
  constexpr std::int64_t longest_gap_ns = 3'600'000'000'000;
  const bool in_order = now_ns >= 0 && now_ns >= held->used_until_ns &&
                        (held->used_until_ns < 0 || now_ns - held->used_until_ns <= longest_gap_ns);
  if (!has_size(out) || !in_order) return ASPERITY_ERROR_INVALID_ARGUMENT;
  device_sample sample;
  const status s = held->device.read(now_ns, sample);
  held->used_until_ns = now_ns;
  held->keep_state();
  asperity_measurement full{};
  if (s == status::ok) {
    full.buttons = sample.buttons;
    full.host_time_ns = sample.host_time_ns;
    full.sequence = sample.sequence;
    put(sample.T_dh, full.pose);
    put(wrench{sample.velocity_d.linear, sample.velocity_d.angular}, full.twist);
  }
  give(out, full);
  return answer(s);
}

std::int32_t asperity_device_write(asperity_haptic_device* device, std::int64_t now_ns, const double* on_hand,
                                   std::int64_t valid_until_ns) {
  std::int32_t code = 0;
  held_device* const held = free_device(device, code);
  if (held == nullptr) return code;
  if (on_hand == nullptr || now_ns < held->used_until_ns) return ASPERITY_ERROR_INVALID_ARGUMENT;
  device_command command{.on_hand = {vec3_of(on_hand), vec3_of(on_hand + 3)},
                         .frame = wrench_frame::device_base,
                         .valid_until_ns = valid_until_ns};
  const bool finite = is_finite(command.on_hand);
  if (!finite) command.on_hand = {};
  const status s = held->device.write(now_ns, command);
  held->used_until_ns = now_ns;
  held->keep_state();
  return s == status::ok && !finite ? ASPERITY_STATUS_NOT_FINITE : answer(s);
}

std::int32_t asperity_device_get_limits(const asperity_haptic_device* device, asperity_device_limits* out) {
  if (checked(device) == nullptr || !has_size(out)) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const device_capabilities& can = device->inside->device.capabilities();
  asperity_device_limits full{};
  full.sensed = can.sensed;
  full.actuated = can.actuated;
  full.continuous_force_n = can.continuous_force_n;
  full.peak_force_n = can.peak_force_n;
  full.continuous_torque_n_m = can.continuous_torque_n_m;
  full.peak_torque_n_m = can.peak_torque_n_m;
  full.max_stiffness_n_per_m = can.max_stiffness_n_per_m;
  full.max_stiffness_rate_hz = can.max_stiffness_rate_hz;
  full.nominal_rate_hz = can.nominal_rate_hz;
  give(out, full);
  return ASPERITY_STATUS_OK;
}

std::uint32_t asperity_device_state(const asperity_haptic_device* device) {
  return checked(device) == nullptr ? ASPERITY_DEVICE_ABSENT : device->inside->state.load(std::memory_order_relaxed);
}
