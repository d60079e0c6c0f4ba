// A moteus controller. It reads what it is told with a parser of its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

#include "asperity/drivers/moteus/moteus_codec.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity::test_support {

class fake_moteus {
 public:
  struct settings {
    std::uint32_t id = 1;
    std::uint32_t host_id = 0;
    std::int32_t register_map = 5;
    std::int64_t enabling_ns = 2'000'000;
  };
  fake_moteus(can_bus& bus, const settings& c) : bus_(bus), settings_(c) {}

  double position_rad = 0.0;  ///< of the output
  double velocity_rad_per_s = 0.0;

  [[nodiscard]] bool enabled() const { return mode_ == 10; }
  /// Torque of the command; a gain that is not scaled to zero, or a position, would be a fault of the host, and is NaN.
  [[nodiscard]] double torque_n_m() const {
    if (mode_ != 10) return 0.0;
    if (!std::isnan(position_) || kp_ != 0.0 || kd_ != 0.0 || integral_ != 0.0) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    return std::clamp(torque_, -most_, most_);
  }
  [[nodiscard]] int enables() const { return enables_; }
  [[nodiscard]] bool watchdog_expired() const { return expired_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] int mode() const { return mode_; }
  [[nodiscard]] double watchdog_s() const { return watchdog_s_; }
  [[nodiscard]] double most_torque_n_m() const { return most_; }

  void mute(bool on) { mute_ = on; }
  void fail(std::uint8_t code) {
    fault_ = code;
    mode_ = 1;
  }
  void reset(std::int64_t now_ns, std::int64_t boot_ns) {
    boots_until_ns_ = now_ns + boot_ns;
    mode_ = 0;
    fault_ = 0;
    torque_ = 0.0;
  }
  void refuse_next_read() { refuse_ = true; }

  void step(std::int64_t now_ns) {
    can_frame f;
    while (bus_.receive(now_ns, f) == io_status::ok) {
      if (now_ns >= boots_until_ns_) take(now_ns, f);
    }
    if (mode_ == 2 && now_ns >= enabled_at_ns_) mode_ = 10;
    if (mode_ == 10 && watchdog_s_ > 0.0 && static_cast<double>(now_ns - fed_ns_) * 1e-9 > watchdog_s_) {
      mode_ = 11;
      expired_ = true;
    }
  }

 private:
  // Plain reading of the document: head, count, register, values. Written apart from the codec on purpose.
  void take(std::int64_t now_ns, const can_frame& f) {
    if (!f.fd || f.remote || (f.id & 0x7fU) != settings_.id || (f.id & 0x7f00U) >> 8U != settings_.host_id) return;
    ++frames_;
    std::size_t at = 0;
    bool commanded = false;
    moteus::frame_writer reply;
    while (at < f.size) {
      const unsigned head = f.data[at++];
      if (head == 0x50) continue;
      const unsigned how = (head >> 2U) & 3U;
      std::uint32_t count = head & 3U;
      if (count == 0 && !varuint(f, at, count)) return;
      std::uint32_t first = 0;
      if (!varuint(f, at, first)) return;
      if (head < 0x10) {
        for (std::uint32_t i = 0; i < count; ++i) {
          const std::size_t n = how == 0 ? 1 : how == 1 ? 2 : 4;
          if (at + n > f.size) return;
          write(first + i, f.data.data() + at, how, commanded);
          at += n;
        }
      } else if (head < 0x20) {
        read(reply, first, count, how);
      } else {
        return;
      }
    }
    if (commanded) begin(now_ns);
    if ((f.id & 0x8000U) == 0 || mute_) return;
    can_frame out{.id = settings_.id << 8U | settings_.host_id, .extended = settings_.id > 7, .fd = true};
    out.size = static_cast<std::uint8_t>(reply.finish(out.data));
    if (out.size > 0) static_cast<void>(bus_.send(now_ns, out));
  }

  void write(std::uint32_t at, const std::uint8_t* b, unsigned how, bool& commanded) {
    const double v = number(b, how, at);
    if (at == 0) {
      wanted_mode_ = v >= 0.0 && v <= 255.0 ? static_cast<int>(v) : -1;  // -1: no mode there is
      commanded = true;
      position_ = 0.0;
      torque_ = 0.0;
      kp_ = kd_ = integral_ = 1.0;
      most_ = std::numeric_limits<double>::infinity();
      watchdog_s_ = 0.1;
    }
    if (at == 0x20) position_ = v;
    if (at == 0x22) torque_ = v;
    if (at == 0x23) kp_ = v;
    if (at == 0x24) kd_ = v;
    if (at == 0x25) most_ = v;
    if (at == 0x27) watchdog_s_ = v;
    if (at == 0x2b) integral_ = v;
  }

  [[nodiscard]] static double number(const std::uint8_t* b, unsigned how, std::uint32_t at) {
    if (how == 3) {
      float f = 0.0F;
      std::memcpy(&f, b, 4);
      return static_cast<double>(f);
    }
    std::int32_t n = 0;
    if (how == 0) n = static_cast<std::int8_t>(b[0]);
    if (how == 1) n = static_cast<std::int16_t>(b[0] | b[1] << 8);
    if (how == 2) std::memcpy(&n, b, 4);
    const std::int32_t none = how == 0 ? -128 : how == 1 ? -32768 : std::numeric_limits<std::int32_t>::min();
    if (n == none) return std::numeric_limits<double>::quiet_NaN();
    const bool time = at == 0x27;
    return time ? n * (how == 0 ? 0.01 : how == 1 ? 0.001 : 1e-6) : n;
  }

  void begin(std::int64_t now_ns) {
    fed_ns_ = now_ns;
    if (wanted_mode_ == 0) {
      mode_ = 0;
      fault_ = 0;
    } else if (wanted_mode_ == 10 && mode_ == 0) {
      mode_ = 2;
      enabled_at_ns_ = now_ns + settings_.enabling_ns;
      ++enables_;
    }
  }

  void read(moteus::frame_writer& w, std::uint32_t first, std::uint32_t count, unsigned how) {
    if (refuse_) {
      refuse_ = false;
      w.error(moteus::action::read_error, static_cast<moteus::reg>(first), 1);
      return;
    }
    constexpr double turn = 2.0 * std::numbers::pi;
    w.begin(moteus::action::reply, static_cast<moteus::resolution>(how), count, static_cast<moteus::reg>(first));
    for (std::uint32_t i = 0; i < count; ++i) {
      switch (first + i) {
        case 0x000:
          w.value(mode_, moteus::quantity::plain);
          break;
        case 0x001:
          w.value(position_rad / turn, moteus::quantity::position_rev);
          break;
        case 0x002:
          w.value(velocity_rad_per_s / turn, moteus::quantity::velocity_rev_per_s);
          break;
        case 0x003:
          w.value(torque_n_m(), moteus::quantity::torque_n_m);
          break;
        case 0x00f:
          w.value(fault_, moteus::quantity::plain);
          break;
        case 0x101:
          w.value(0x010304, moteus::quantity::plain);
          break;
        case 0x102:
          w.value(settings_.register_map, moteus::quantity::plain);
          break;
        default:
          w.value(0.0, moteus::quantity::plain);
          break;
      }
    }
  }

  [[nodiscard]] static bool varuint(const can_frame& f, std::size_t& at, std::uint32_t& out) {
    out = 0;
    for (unsigned shift = 0; shift < 35 && at < f.size; shift += 7) {
      const std::uint32_t b = f.data[at++];
      out |= (b & 0x7fU) << shift;
      if ((b & 0x80U) == 0) return true;
    }
    return false;
  }

  can_bus& bus_;
  settings settings_;
  std::int64_t fed_ns_ = 0, boots_until_ns_ = 0, enabled_at_ns_ = 0;
  std::uint64_t frames_ = 0;
  double position_ = 0.0, torque_ = 0.0, kp_ = 1.0, kd_ = 1.0, integral_ = 1.0, most_ = 0.0, watchdog_s_ = 0.0;
  int mode_ = 0, wanted_mode_ = 0, enables_ = 0;
  std::uint8_t fault_ = 0;
  bool mute_ = false, expired_ = false, refuse_ = false;
};

}  // namespace asperity::test_support
