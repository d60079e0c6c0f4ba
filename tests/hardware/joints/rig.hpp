// One joint drive and its fake peer on a virtual bus, run as an owner runs them: 1 kHz, receive, torque, step.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <utility>

#include "asperity/drivers/mit/mit_drive.hpp"
#include "asperity/drivers/moteus/moteus_drive.hpp"
#include "asperity/drivers/odrive/odrive_drive.hpp"
#include "asperity/transport/virtual/manual_clock.hpp"
#include "asperity/transport/virtual/virtual_can.hpp"
#include "hardware/peers/fake_mit.hpp"
#include "hardware/peers/fake_moteus.hpp"
#include "hardware/peers/fake_odrive.hpp"

namespace asperity::test_support {

constexpr std::int64_t ms = 1'000'000;

/// A geared and reversed joint, so that a forgotten sign or ratio shows.
inline joint_drive_settings geared() {
  joint_drive_settings o;
  o.scale = {.gear_ratio = 6.0, .reversed = true, .zero_rad = 0.25};
  o.peak_torque_n_m = 20.0;
  return o;
}

/// What a fault of the drive itself is: what makes the peer have it, and what the driver has to say.
struct own_fault {
  std::uint32_t sent;
  std::uint32_t code;
  const char* word;
};

// Each kind reads the torque in a frame by itself, in the shaft's N m; nullopt where the frame carries none.
struct mit_kind {
  using drive = mit_drive;
  using fake = fake_mit;
  static constexpr const char* name = "MIT";
  static constexpr own_fault broken{2, 2, "over-current"};
  static mit_settings options(const joint_drive_settings& joint) {
    return {.joint = joint, .ranges = mit::ak60_6, .watchdog_set = true};
  }
  static fake::settings peer() { return {.ranges = mit::ak60_6}; }
  static std::optional<double> torque_of(const can_frame& f) {
    bool special = true;
    for (std::size_t i = 0; i < 7; ++i) special = special && f.data[i] == 0xff;
    if (special) return std::nullopt;
    // Gains on the wire would be a torque of their own.
    if ((f.data[3] & 0xf) != 0 || f.data[4] != 0 || f.data[5] != 0 || (f.data[6] & 0xf0) != 0) return std::nan("");
    return ((f.data[6] & 0xf) << 8 | f.data[7]) * 30.0 / 4095.0 - 15.0;
  }
};

struct odrive_kind {
  using drive = odrive_drive;
  using fake = fake_odrive;
  static std::optional<double> torque_of(const can_frame& f) {
    if ((f.id & 0x1fU) != 0x0e) return std::nullopt;
    float t = 0.0F;
    std::memcpy(&t, f.data.data(), 4);
    return static_cast<double>(t);
  }
};
struct odrive_0_6_kind : odrive_kind {
  static constexpr const char* name = "ODrive 0.6";
  static constexpr own_fault broken{0x100, 0x100, "over-voltage"};
  static odrive_settings options(const joint_drive_settings& joint) {
    odrive_settings o{.joint = joint, .node = 3, .watchdog_set = true};
    o.joint.quiet_ns = 30 * ms;
    return o;
  }
  static fake::settings peer() { return {}; }
};
struct odrive_0_5_kind : odrive_kind {
  static constexpr const char* name = "ODrive 0.5";
  static constexpr own_fault broken{0x40, 0x40, "motor"};
  static odrive_settings options(const joint_drive_settings& joint) {
    odrive_settings o = odrive_0_6_kind::options(joint);
    o.torque_constant_n_m_per_a = 0.05;
    return o;
  }
  static fake::settings peer() { return {.firmware = odrive::firmware::v0_5}; }
};

struct moteus_kind {
  using drive = moteus_drive;
  using fake = fake_moteus;
  static constexpr const char* name = "moteus";
  static constexpr own_fault broken{34, 34, "over-voltage"};
  static moteus_settings options(const joint_drive_settings& joint) { return {.joint = joint}; }
  static fake::settings peer() { return {}; }
  static std::optional<double> torque_of(const can_frame& f) {
    // The one form in which the driver commands; whatever else writes a mode is a stop.
    if (f.size < 3 || f.data[0] != 0x01 || f.data[1] != 0x00 || f.data[2] != 0x0a) return std::nullopt;
    EXPECT_EQ(f.data[6], 0x0d);
    EXPECT_EQ(f.data[7], 0x22);
    float t = 0.0F;
    std::memcpy(&t, f.data.data() + 8, 4);
    return static_cast<double>(t);
  }
};

/// The host's end of the bus, with a look at everything that is sent.
class watched_bus final : public can_bus {
 public:
  watched_bus(can_bus& bus, std::function<void(const can_frame&)> look) : bus_(bus), look_(std::move(look)) {}
  [[nodiscard]] io_status send(std::int64_t now_ns, const can_frame& frame) noexcept override {
    look_(frame);
    return bus_.send(now_ns, frame);
  }
  [[nodiscard]] io_status receive(std::int64_t now_ns, can_frame& frame) noexcept override {
    return bus_.receive(now_ns, frame);
  }
  [[nodiscard]] can_health health() const noexcept override { return bus_.health(); }
  [[nodiscard]] bool takes_fd() const noexcept override { return bus_.takes_fd(); }

 private:
  can_bus& bus_;
  std::function<void(const can_frame&)> look_;
};

template <class Kind>
class rig {
 public:
  using options_type = decltype(Kind::options(geared()));

  explicit rig(link_script script = {}, options_type options = Kind::options(geared()),
               typename Kind::fake::settings peer_settings = Kind::peer())
      : host(bus, std::move(script)),
        far(bus),
        peer(far, peer_settings),
        drive(options),
        watched(host, [this](const can_frame& f) { look(f); }) {
    clock.on_advance([this](std::int64_t now_ns) { peer.step(now_ns); });
  }

  /// One period. A bus that does not give frames any more makes the owner disable the drive.
  void tick() {
    clock.advance_ns(ms);
    const std::int64_t now_ns = clock.now_ns();
    can_frame f;
    for (int i = 0; i < 64; ++i) {
      const io_status s = host.receive(now_ns, f);
      if (s == io_status::nothing) break;
      if (s != io_status::ok) {
        receive_failed = s;
        drive.disable(now_ns);
        break;
      }
      drive.take(now_ns, f);
    }
    if (drive.state() == drive_state::enabled && feeding) drive.set_torque(wanted_n_m);
    last = drive.step(now_ns, watched);
    was_enabled = was_enabled || drive.state() == drive_state::enabled;
    if (trusted_link) {
      EXPECT_LE(std::fabs(joint_torque()), peak_n_m_ * (1.0 + 1e-6)) << Kind::name;
    }
  }
  void run(std::int64_t duration_ns) {
    for (std::int64_t t = 0; t < duration_ns; t += ms) tick();
  }
  /// Runs until the drive is in that state. @return whether it came to it
  bool run_until(drive_state wanted, std::int64_t limit_ns = 1000 * ms) {
    for (std::int64_t t = 0; t < limit_ns && drive.state() != wanted; t += ms) tick();
    return drive.state() == wanted;
  }
  bool bring_up() {
    drive.start(clock.now_ns());
    return run_until(drive_state::idle);
  }
  bool go(double torque_n_m = 0.0) {
    if (!bring_up() || !drive.enable(clock.now_ns())) return false;
    wanted_n_m = torque_n_m;
    return run_until(drive_state::enabled);
  }

  /// Torque that the joint feels, N m.
  [[nodiscard]] double joint_torque() const { return peer.torque_n_m() * -gear_; }
  [[nodiscard]] double zero_error() const { return std::fabs(drive.facts().zero_torque_error_n_m) + 1e-5; }
  [[nodiscard]] bool is_limp() const { return std::fabs(joint_torque()) <= zero_error(); }
  [[nodiscard]] bool why_contains(const char* word) const {
    return std::string(drive.fault().what).find(word) != std::string::npos;
  }

  manual_clock clock{1'000'000'000};
  virtual_can bus{true};
  virtual_can_node host;
  virtual_can_node far;
  typename Kind::fake peer;
  typename Kind::drive drive;
  watched_bus watched;
  double wanted_n_m = 0.0;
  double last_on_wire_n_m = 0.0;
  bool feeding = true;
  bool was_enabled = false;
  bool trusted_link = true;  // false where the link flips bits on the way to the peer
  io_status last = io_status::ok;
  io_status receive_failed = io_status::ok;

 private:
  // Every frame of every test: within the peak, and zero unless enabled.
  void look(const can_frame& f) {
    const std::optional<double> t = Kind::torque_of(f);
    if (!t) return;
    last_on_wire_n_m = *t * -gear_;
    EXPECT_LE(std::fabs(last_on_wire_n_m), peak_n_m_ * (1.0 + 1e-12)) << Kind::name;
    if (drive.state() == drive_state::enabled) {
      // Zero may decode to either side of it; anything else keeps its sign.
      if (std::fabs(last_on_wire_n_m) > zero_error()) {
        EXPECT_GE(last_on_wire_n_m * wanted_n_m, 0.0) << Kind::name;
      }
    } else {
      EXPECT_LE(std::fabs(last_on_wire_n_m), zero_error()) << Kind::name << ": " << to_string(drive.state());
    }
  }

  const double gear_ = geared().scale.gear_ratio;
  const double peak_n_m_ = geared().peak_torque_n_m;
};

template <class Kind>
class JointDrives : public ::testing::Test {};
using every_kind = ::testing::Types<mit_kind, odrive_0_5_kind, odrive_0_6_kind, moteus_kind>;

}  // namespace asperity::test_support
