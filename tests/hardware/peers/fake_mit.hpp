// A motor that speaks the MIT protocol, as the motorcontrol firmware does: it answers every frame, and says nothing of
// its mode.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "asperity/drivers/mit/mit_codec.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity::test_support {

class fake_mit {
 public:
  struct settings {
    std::uint8_t id = 1;
    std::uint32_t master_id = 0;
    mit::ranges ranges = mit::ak80_9;
    std::uint8_t reply_size = 8;
    std::int64_t watchdog_ns = 20'000'000;  ///< 0: none
  };
  fake_mit(can_bus& bus, const settings& c) : bus_(bus), settings_(c) {}

  double position_rad = 0.0;  ///< of the shaft; may be outside the range, and wraps on the wire
  double velocity_rad_per_s = 0.0;

  [[nodiscard]] bool enabled() const { return motor_mode_; }
  [[nodiscard]] double torque_n_m() const { return motor_mode_ ? command_.torque_n_m + spring() : 0.0; }
  [[nodiscard]] int enables() const { return enables_; }
  [[nodiscard]] bool watchdog_expired() const { return expired_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }

  void mute(bool on) { mute_ = on; }
  void fail(std::uint8_t code) { error_ = code; }
  void reset(std::int64_t now_ns, std::int64_t boot_ns) {
    boots_until_ns_ = now_ns + boot_ns;
    motor_mode_ = false;
    command_ = {};
  }
  void answer_size(std::uint8_t bytes) { settings_.reply_size = bytes; }

  void step(std::int64_t now_ns) {
    can_frame f;
    while (bus_.receive(now_ns, f) == io_status::ok) {
      if (now_ns >= boots_until_ns_) take(now_ns, f);
    }
    if (motor_mode_ && settings_.watchdog_ns > 0 && now_ns - fed_ns_ > settings_.watchdog_ns) {
      expired_ = expired_ || command_.torque_n_m != 0.0;
      command_ = {};
    }
  }

 private:
  void take(std::int64_t now_ns, const can_frame& f) {
    if (f.id != settings_.id || f.extended || f.remote || f.size != 8) return;
    ++frames_;
    answer(now_ns);
    static constexpr std::uint8_t ones[7] = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
    const bool special = std::memcmp(f.data.data(), ones, 7) == 0;
    if (special && f.data[7] == 0xfc) {
      enables_ += motor_mode_ ? 0 : 1;
      motor_mode_ = true;
    } else if (special && f.data[7] == 0xfd) {
      motor_mode_ = false;
      command_ = {};
    } else if (!special || f.data[7] != 0xfe) {
      // As the firmware computes it, in float, and not with the codec under test.
      const auto value = [](int u, double most, int bits) {
        const auto low = static_cast<float>(-most);
        const float span = static_cast<float>(most) - low;
        return static_cast<double>(static_cast<float>(u) * span / static_cast<float>((1 << bits) - 1) + low);
      };
      const auto& d = f.data;
      command_.position_rad = value(d[0] << 8 | d[1], settings_.ranges.position_rad, 16);
      command_.velocity_rad_per_s = value(d[2] << 4 | d[3] >> 4, settings_.ranges.velocity_rad_per_s, 12);
      command_.stiffness_n_m_per_rad = ((d[3] & 0xf) << 8 | d[4]) / 4095.0 * settings_.ranges.stiffness_n_m_per_rad;
      command_.damping_n_m_s_per_rad = (d[5] << 4 | d[6] >> 4) / 4095.0 * settings_.ranges.damping_n_m_s_per_rad;
      command_.torque_n_m = value((d[6] & 0xf) << 8 | d[7], settings_.ranges.torque_n_m, 12);
      fed_ns_ = now_ns;
    }
  }

  void answer(std::int64_t now_ns) {
    if (mute_) return;
    const double counts = (position_rad / settings_.ranges.position_rad + 1.0) * 65535.0 / 2.0;
    const mit::reply r{.id = settings_.id,
                       .position_counts = static_cast<std::uint16_t>(static_cast<std::int64_t>(counts)),
                       .velocity_rad_per_s = velocity_rad_per_s,
                       .torque_n_m = torque_n_m(),
                       .size = settings_.reply_size,
                       .error = error_,
                       .temperature_c = 30,
                       .voltage_counts = 120};
    mit::command_bytes b{};
    can_frame f{.id = settings_.master_id};
    f.size = static_cast<std::uint8_t>(mit::encode_reply(r, settings_.ranges, b));
    std::copy(b.begin(), b.end(), f.data.begin());
    static_cast<void>(bus_.send(now_ns, f));
  }

  [[nodiscard]] double spring() const {
    return command_.stiffness_n_m_per_rad * (command_.position_rad - position_rad) +
           command_.damping_n_m_s_per_rad * (command_.velocity_rad_per_s - velocity_rad_per_s);
  }

  can_bus& bus_;
  settings settings_;
  mit::command command_{};
  std::int64_t fed_ns_ = 0;
  std::int64_t boots_until_ns_ = 0;
  std::uint64_t frames_ = 0;
  int enables_ = 0;
  std::uint8_t error_ = 0;
  bool motor_mode_ = false;
  bool mute_ = false;
  bool expired_ = false;
};

}  // namespace asperity::test_support
