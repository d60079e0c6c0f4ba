// A joint drive that speaks ODrive's CANSimple, firmware 0.5 or 0.6.
#pragma once

#include <cstdint>
#include <numbers>

#include "asperity/drivers/joint/can_joint_drive.hpp"
#include "asperity/drivers/odrive/odrive_codec.hpp"

namespace asperity {

struct odrive_settings {
  /// Estimates of the encoder come every 10 ms unless you set the drive to less, so quiet is longer than elsewhere.
  joint_drive_settings joint{.quiet_ns = 30'000'000};
  std::uint32_t node = 0;  ///< 0-63
  enum class version : std::uint8_t { ask, v0_5, v0_6 } firmware = version::ask;
  bool ask_estimates = true;  ///< 0.5: ask for them in every period; false where the drive sends them often
  double torque_constant_n_m_per_a = 0.0;   ///< 0.5: of the motor, turns its current into a torque; 0: none is measured
  std::int64_t heartbeat_ns = 350'000'000;  ///< three heartbeats as they are set by default, and a half
  bool watchdog_set = false;                ///< enable_watchdog and watchdog_timeout are set in the drive
};

/// A drive of 0.5 does not know the question for its version, so one that beats and does not answer it is 0.5.
/// Its watchdog is fed by every frame: enabled, nothing at all is sent in a period without a new torque.
/// @rt safe
class odrive_drive final : public can_joint_drive {
 public:
  explicit odrive_drive(const odrive_settings& settings) noexcept
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

  /// Which table is spoken; what was asked for, once the drive leads to idle.
  [[nodiscard]] odrive::firmware firmware() const noexcept { return firmware_; }

  bool take(std::int64_t now_ns, const can_frame& frame) noexcept override {
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

 private:
  static constexpr double turn = 2.0 * std::numbers::pi;
  static constexpr std::int64_t pace_ns = 20'000'000;        // of frames that are repeated until they are answered
  static constexpr std::int64_t ask_ns = 150'000'000;        // for an answer to the question for the version
  static constexpr std::int64_t estop_ns = 400'000'000;      // a drive that is not idle after that is stopped harder
  static constexpr std::int64_t old_error_ns = 250'000'000;  // heartbeats from before the errors were cleared

  void begin_lead(bool clearing) noexcept override {
    clearing_ = clearing;
    owes_clearing_ = clearing;
    has_estimate_ = false;
    beat_ = false;
    first_ = true;
    known_ = odrive_.firmware != odrive_settings::version::ask;
    firmware_ = odrive_.firmware == odrive_settings::version::v0_6 ? odrive::firmware::v0_6 : odrive::firmware::v0_5;
  }

  void take_version(std::int64_t now_ns, const odrive::version& v) noexcept {
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

  void take_error(std::int64_t now_ns, std::uint32_t error) noexcept {
    const bool excused = at() == phase::leading && (!known_ || clearing_);
    if (error == 0 || excused) return;
    fail(firmware_ == odrive::firmware::v0_6 ? odrive::to_string_error(error, firmware_)
                                             : "the drive reports a fault of its motor",
         error, now_ns);
  }

  void take_heartbeat(std::int64_t now_ns, const odrive::heartbeat& h) noexcept {
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
          fail("the drive left closed loop by itself: it was reset, disarmed or stopped by another", axis_state_,
               now_ns);
        }
        break;
      default:
        break;
    }
  }

  void send_due(std::int64_t now_ns, can_bus& bus) noexcept override {
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
        if (is_due(now_ns) && send(now_ns, bus, odrive::set_torque_mode(odrive_.node)) &&
            send_torque(now_ns, bus, 0.0)) {
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

  void lead_on(std::int64_t now_ns, can_bus& bus) noexcept {
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

  void disarm(std::int64_t now_ns, can_bus& bus) noexcept {
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

  // A heartbeat of an idle axis, and not one from before it was asked to be idle.
  [[nodiscard]] bool is_off() const noexcept {
    return !owes_zero() && idle_requests_ >= 2 && axis_state_ == odrive::axis_idle && beat_ns_ > asked_ns_;
  }

  // Once at the beginning of something, and then at a pace.
  [[nodiscard]] bool is_due(std::int64_t now_ns) noexcept {
    if (!first_ && now_ns - paced_ns_ < pace_ns) return false;
    first_ = false;
    paced_ns_ = now_ns;
    return true;
  }

  void ask_estimates(std::int64_t now_ns, can_bus& bus) noexcept {
    if (firmware_ != odrive::firmware::v0_5 || !odrive_.ask_estimates) return;
    send(now_ns, bus, odrive::ask(odrive_.node, odrive::message::encoder_estimates, true));
    if (odrive_.torque_constant_n_m_per_a > 0.0) {
      send(now_ns, bus, odrive::ask(odrive_.node, odrive::message::iq, true));
    }
  }

  bool send_torque(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept {
    return send(now_ns, bus, odrive::set_input_torque(odrive_.node, scale().shaft_torque(joint_n_m), limit_));
  }
  bool send(std::int64_t now_ns, can_bus& bus, const can_frame& f) noexcept { return put(now_ns, bus, f); }

  odrive_settings odrive_;
  float limit_;
  odrive::firmware firmware_ = odrive::firmware::v0_5;
  std::int64_t paced_ns_ = 0;
  std::int64_t beat_ns_ = 0;
  std::int64_t asked_ns_ = 0;  // when it was first asked to be idle
  std::uint8_t axis_state_ = 0;
  int idle_requests_ = 0;  // in this phase, up to 2
  bool known_ = false;     // which table
  bool beat_ = false;      // a heartbeat was heard on this way to idle
  bool has_estimate_ = false;
  bool clearing_ = false;
  bool owes_clearing_ = false;
  bool first_ = true;
  bool remote_ = false;
};

}  // namespace asperity
