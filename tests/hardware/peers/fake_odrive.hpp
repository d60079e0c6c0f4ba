// An ODrive axis on CANSimple, firmware 0.5 or 0.6.
#pragma once

#include <cstdint>
#include <cstring>
#include <numbers>

#include "asperity/drivers/odrive/odrive_codec.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity::test_support {

class fake_odrive {
 public:
  struct settings {
    std::uint32_t node = 3;
    odrive::firmware firmware = odrive::firmware::v0_6;
    odrive::version version{2, 4, 4, 58, 0, 6, 9, 0};  ///< what 0.6 answers
    std::int64_t heartbeat_ns = 20'000'000;
    std::int64_t estimates_ns = 1'000'000;  ///< 0.6; 0.5 sends none unless it is asked
    std::int64_t watchdog_ns = 20'000'000;  ///< 0: none
    double torque_constant = 0.05;
  };
  fake_odrive(can_bus& bus, const settings& c) : bus_(bus), settings_(c) {}

  double position_rad = 0.0;  ///< of the motor
  double velocity_rad_per_s = 0.0;

  [[nodiscard]] bool enabled() const { return state_ == odrive::axis_closed_loop; }
  [[nodiscard]] double torque_n_m() const {
    return enabled() && control_mode_ == 1 && input_mode_ == 1 ? static_cast<double>(input_torque_) : 0.0;
  }
  [[nodiscard]] int enables() const { return enables_; }
  [[nodiscard]] bool watchdog_expired() const { return expired_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t remote_frames() const { return remote_; }
  [[nodiscard]] bool stopped_hard() const { return estops_ > 0; }

  void mute(bool on) { mute_ = on; }
  /// Goes to idle with that error, as a disarmed axis does.
  void fail(std::uint32_t error) {
    error_ |= error;
    state_ = odrive::axis_idle;
  }
  void reset(std::int64_t now_ns, std::int64_t boot_ns) {
    boots_until_ns_ = now_ns + boot_ns;
    state_ = odrive::axis_idle;
    error_ = 0;
    input_torque_ = 0.0F;
    control_mode_ = 3;
    offset_rad_ = position_rad;
  }
  /// Requests for idle are not obeyed from now on.
  void stick() { stuck_ = true; }
  /// Control of another kind, left behind by another program.
  void leave_behind(float torque) {
    state_ = odrive::axis_closed_loop;
    control_mode_ = 1;
    input_mode_ = 1;
    input_torque_ = torque;
    ++enables_;
  }

  void step(std::int64_t now_ns) {
    can_frame f;
    while (bus_.receive(now_ns, f) == io_status::ok) {
      if (now_ns >= boots_until_ns_) take(now_ns, f);
    }
    if (now_ns < boots_until_ns_) return;
    if (enabled() && settings_.watchdog_ns > 0 && now_ns - fed_ns_ > settings_.watchdog_ns) {
      expired_ = true;
      fail(settings_.firmware == odrive::firmware::v0_6 ? 0x1000000U : 0x800U);
    }
    if (mute_) return;
    if (now_ns - beat_ns_ >= settings_.heartbeat_ns) {
      beat_ns_ = now_ns;
      const odrive::heartbeat h{.axis_error = error_, .axis_state = state_};
      static_cast<void>(bus_.send(now_ns, odrive::encode_heartbeat(settings_.node, h, settings_.firmware)));
    }
    if (settings_.firmware == odrive::firmware::v0_6 && now_ns - estimates_ns_ >= settings_.estimates_ns) {
      estimates_ns_ = now_ns;
      send_estimates(now_ns);
      const auto t = static_cast<float>(torque_n_m());
      static_cast<void>(bus_.send(now_ns, odrive::encode_floats(settings_.node, odrive::message::torques, {t, t})));
    }
  }

 private:
  void take(std::int64_t now_ns, const can_frame& f) {
    if (f.extended || f.id >> 5U != settings_.node) return;
    ++frames_;
    remote_ += f.remote ? 1 : 0;
    const std::uint32_t command = f.id & 0x1fU;
    const bool is_0_5 = settings_.firmware == odrive::firmware::v0_5;
    // 0.5 feeds its watchdog with every frame.
    if (is_0_5 || command == 0x0e) fed_ns_ = now_ns;
    const bool getter = f.remote || f.size == 0;
    switch (command) {
      case 0x00:
        if (!is_0_5 && getter && !mute_) {
          static_cast<void>(bus_.send(now_ns, odrive::encode_version(settings_.node, settings_.version)));
        }
        break;
      case 0x02:
        ++estops_;
        stuck_ = false;
        fail(is_0_5 ? 0x4000U : 0x2000000U);
        break;
      case 0x07:
        if (f.size >= 4) request(now_ns, word(f, 0));
        break;
      case 0x09:
        if (is_0_5 && getter && !mute_) send_estimates(now_ns);
        break;
      case 0x0b:
        if (f.size == 8) {
          control_mode_ = word(f, 0);
          input_mode_ = word(f, 4);
        }
        break;
      case 0x0e:
        if (f.size >= 4) std::memcpy(&input_torque_, f.data.data(), 4);
        break;
      case 0x14:
        if (is_0_5 && getter && !mute_) {
          const auto amperes = static_cast<float>(torque_n_m() / settings_.torque_constant);
          static_cast<void>(
              bus_.send(now_ns, odrive::encode_floats(settings_.node, odrive::message::iq, {0, amperes})));
        }
        break;
      case 0x18:
        error_ = 0;
        break;
      default:
        break;
    }
  }

  void request(std::int64_t now_ns, std::uint32_t state) {
    if (state == odrive::axis_closed_loop && error_ == 0) {
      enables_ += enabled() ? 0 : 1;
      state_ = odrive::axis_closed_loop;
      fed_ns_ = now_ns;
    } else if (state == odrive::axis_idle && !stuck_) {
      state_ = odrive::axis_idle;
    }
  }

  void send_estimates(std::int64_t now_ns) {
    constexpr double turn = 2.0 * std::numbers::pi;
    const auto p = static_cast<float>((position_rad - offset_rad_) / turn);
    const auto v = static_cast<float>(velocity_rad_per_s / turn);
    static_cast<void>(
        bus_.send(now_ns, odrive::encode_floats(settings_.node, odrive::message::encoder_estimates, {p, v})));
  }

  [[nodiscard]] static std::uint32_t word(const can_frame& f, std::size_t at) {
    std::uint32_t w = 0;
    std::memcpy(&w, f.data.data() + at, 4);
    return w;
  }

  can_bus& bus_;
  settings settings_;
  std::int64_t fed_ns_ = 0, beat_ns_ = 0, estimates_ns_ = 0, boots_until_ns_ = 0;
  std::uint64_t frames_ = 0, remote_ = 0;
  std::uint32_t error_ = 0, control_mode_ = 3, input_mode_ = 1;
  float input_torque_ = 0.0F;
  double offset_rad_ = 0.0;
  int enables_ = 0, estops_ = 0;
  std::uint8_t state_ = odrive::axis_idle;
  bool mute_ = false, expired_ = false, stuck_ = false;
};

}  // namespace asperity::test_support
