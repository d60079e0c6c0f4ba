#include "asperity/drivers/odrive/odrive_drive.hpp"

#include <cstdint>

namespace asperity {

odrive_drive::odrive_drive(const odrive_settings& settings) noexcept
    : can_joint_drive(settings.joint),
      odrive_(settings),
      limit_(scale().shaft_limit(this->settings().peak_torque_n_m)) {
  drive_facts& f = facts_to_fill();
  constexpr double float_step = 1.0 / 8388608.0;
  f.protocol = "ODrive CANSimple";
  f.torque_resolution_n_m = f.peak_torque_n_m * float_step;
  f.position_resolution_rad = turn * float_step / scale().gear_ratio;
  f.drive_side_watchdog = settings.watchdog_set;
  const bool constant = settings.torque_constant_n_m_per_a >= 0.0 && settings.torque_constant_n_m_per_a < 1e3;
  if (settings.node > odrive::most_node || settings.heartbeat_ns <= 0 || !constant) refuse_settings();
}

bool odrive_drive::take(std::int64_t now_ns, const can_frame& frame) noexcept {
  if (frame.extended || frame.remote || frame.fd || frame.id >> 5U != odrive_.node) return false;
  const auto m = static_cast<odrive::message>(frame.id & 0x1fU);
  const bool torques = m == odrive::message::torques && firmware_ == odrive::firmware::v0_6;
  if (m != odrive::message::version && m != odrive::message::heartbeat && m != odrive::message::error &&
      m != odrive::message::encoder_estimates && m != odrive::message::iq && !torques) {
    return true;
  }
  if (at() == phase::off) return true;
  if (frame.size != 8) {
    count_malformed();
    return true;
  }
  switch (m) {
    case odrive::message::version:
      take_version(now_ns, odrive::decode_version(frame));
      break;
    case odrive::message::heartbeat:
      take_heartbeat(now_ns, odrive::decode_heartbeat(frame, firmware_));
      break;
    case odrive::message::encoder_estimates: {
      heard(now_ns);
      const odrive::float_pair p = odrive::decode_floats(frame);
      heard_position(now_ns, frame, scale().angle(static_cast<double>(p.first) * turn));
      heard_velocity(scale().velocity(static_cast<double>(p.second) * turn));
      has_estimate_ = true;
      break;
    }
    case odrive::message::error:
      take_error(now_ns, little_u32(frame.data.data()));
      break;
    case odrive::message::iq:
      if (odrive_.torque_constant_n_m_per_a > 0.0 && firmware_ == odrive::firmware::v0_5) {
        const auto amperes = static_cast<double>(odrive::decode_floats(frame).second);
        heard_torque(scale().torque(amperes * odrive_.torque_constant_n_m_per_a));
      }
      break;
    default:
      heard_torque(scale().torque(static_cast<double>(odrive::decode_floats(frame).second)));
      break;
  }
  return true;
}

void odrive_drive::begin_lead(bool clearing) noexcept {
  clearing_ = clearing;
  owes_clearing_ = clearing;
  has_estimate_ = false;
  beat_ = false;
  first_ = true;
  known_ = odrive_.firmware != odrive_settings::version::ask;
  firmware_ = odrive_.firmware == odrive_settings::version::v0_6 ? odrive::firmware::v0_6 : odrive::firmware::v0_5;
}

void odrive_drive::take_version(std::int64_t now_ns, const odrive::version& v) noexcept {
  if (at() != phase::leading || known_) return;
  heard(now_ns);
  if (v.major != 0 || (v.minor != 6 && v.minor != 5)) {
    const std::uint32_t code = static_cast<std::uint32_t>(v.major) << 16U | static_cast<std::uint32_t>(v.minor) << 8U;
    fail("the firmware is neither 0.5 nor 0.6", code | v.revision, now_ns);
    return;
  }
  firmware_ = v.minor == 6 ? odrive::firmware::v0_6 : odrive::firmware::v0_5;
  known_ = true;
}

void odrive_drive::take_error(std::int64_t now_ns, std::uint32_t error) noexcept {
  const bool excused = at() == phase::leading && (!known_ || clearing_);
  if (error == 0 || excused) return;
  fail(firmware_ == odrive::firmware::v0_6 ? odrive::to_string_error(error, firmware_)
                                           : "the drive reports a fault of its motor",
       error, now_ns);
}

void odrive_drive::take_heartbeat(std::int64_t now_ns, const odrive::heartbeat& h) noexcept {
  heard(now_ns);
  beat_ = true;
  beat_ns_ = now_ns;
  axis_state_ = h.axis_state;
  const bool leading = at() == phase::leading;
  if (leading && !known_) return;
  const bool bad = h.axis_error != 0 || h.motor_error || h.encoder_error || h.controller_error;
  if (bad) {
    if (leading && clearing_ && now_ns - since_ns() < old_error_ns) return;
    fail(odrive::to_string_error(h.axis_error, firmware_), h.axis_error, now_ns);
    return;
  }
  switch (at()) {
    case phase::leading:
      if (axis_state_ == odrive::axis_idle && has_estimate_ && !owes_clearing_ && !first_) {
        reached(phase::idle, now_ns);
      }
      break;
    case phase::leaving:
      if (is_off()) reached(phase::idle, now_ns);
      break;
    case phase::idle:
      if (axis_state_ != odrive::axis_idle) fail("the drive left idle by itself", axis_state_, now_ns);
      break;
    case phase::arming:
      if (axis_state_ == odrive::axis_closed_loop) reached(phase::enabled, now_ns);
      break;
    case phase::enabled:
      if (axis_state_ != odrive::axis_closed_loop) {
        fail("the drive left closed loop by itself: it was reset, disarmed or stopped by another", axis_state_, now_ns);
      }
      break;
    default:
      break;
  }
}

void odrive_drive::send_due(std::int64_t now_ns, can_bus& bus) noexcept {
  switch (at()) {
    case phase::leading:
      lead_on(now_ns, bus);
      break;
    case phase::seeking:
      if (is_due(now_ns)) send(now_ns, bus, odrive::set_axis_state(odrive_.node, odrive::axis_idle));
      ask_estimates(now_ns, bus);
      break;
    case phase::idle:
      send_torque(now_ns, bus, 0.0);
      ask_estimates(now_ns, bus);
      first_ = true;
      break;
    case phase::arming:
      // Mode and zero come before the request, so that what an earlier program left behind is never put out.
      if (is_due(now_ns) && send(now_ns, bus, odrive::set_torque_mode(odrive_.node)) && send_torque(now_ns, bus, 0.0)) {
        send(now_ns, bus, odrive::set_axis_state(odrive_.node, odrive::axis_closed_loop));
      } else {
        send_torque(now_ns, bus, 0.0);
      }
      ask_estimates(now_ns, bus);
      break;
    case phase::enabled:
      if (now_ns - beat_ns_ > odrive_.heartbeat_ns) {
        fail("the drive's heartbeats stopped", 0, now_ns);
        disarm(now_ns, bus);
      } else if (is_fed()) {
        send_torque(now_ns, bus, torque_due(now_ns));
        ask_estimates(now_ns, bus);
      }
      first_ = true;
      break;
    case phase::leaving:
    case phase::faulted:
      disarm(now_ns, bus);
      break;
    case phase::off:
      break;
  }
}

void odrive_drive::lead_on(std::int64_t now_ns, can_bus& bus) noexcept {
  if (!known_ && beat_ && now_ns - since_ns() > ask_ns) {
    firmware_ = odrive::firmware::v0_5;
    known_ = true;
    first_ = true;
  }
  ask_estimates(now_ns, bus);
  if (!is_due(now_ns)) return;
  if (!known_) {
    remote_ = !remote_;
    send(now_ns, bus, odrive::ask(odrive_.node, odrive::message::version, remote_));
    return;
  }
  if (!send_torque(now_ns, bus, 0.0)) return;
  send(now_ns, bus, odrive::set_axis_state(odrive_.node, odrive::axis_idle));
  if (owes_clearing_ && send(now_ns, bus, odrive::clear_errors(odrive_.node))) owes_clearing_ = false;
  send(now_ns, bus, odrive::set_torque_mode(odrive_.node));
}

void odrive_drive::disarm(std::int64_t now_ns, can_bus& bus) noexcept {
  if (owes_zero()) {
    first_ = true;
    idle_requests_ = 0;
    if (send_torque(now_ns, bus, 0.0)) zero_was_sent();
    return;
  }
  if (!is_off() && is_due(now_ns)) {
    if (send(now_ns, bus, odrive::set_axis_state(odrive_.node, odrive::axis_idle))) {
      idle_requests_ += idle_requests_ < 2 ? 1 : 0;
      if (idle_requests_ == 1) asked_ns_ = now_ns;
    }
    if (now_ns - since_ns() > estop_ns) send(now_ns, bus, odrive::estop(odrive_.node));
  }
  if (at() == phase::leaving) ask_estimates(now_ns, bus);
}

bool odrive_drive::is_off() const noexcept {
  return !owes_zero() && idle_requests_ >= 2 && axis_state_ == odrive::axis_idle && beat_ns_ > asked_ns_;
}

bool odrive_drive::is_due(std::int64_t now_ns) noexcept {
  if (!first_ && now_ns - paced_ns_ < pace_ns) return false;
  first_ = false;
  paced_ns_ = now_ns;
  return true;
}

void odrive_drive::ask_estimates(std::int64_t now_ns, can_bus& bus) noexcept {
  if (firmware_ != odrive::firmware::v0_5 || !odrive_.ask_estimates) return;
  send(now_ns, bus, odrive::ask(odrive_.node, odrive::message::encoder_estimates, true));
  if (odrive_.torque_constant_n_m_per_a > 0.0) {
    send(now_ns, bus, odrive::ask(odrive_.node, odrive::message::iq, true));
  }
}

bool odrive_drive::send_torque(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept {
  return send(now_ns, bus, odrive::set_input_torque(odrive_.node, scale().shaft_torque(joint_n_m), limit_));
}

}  // namespace asperity
