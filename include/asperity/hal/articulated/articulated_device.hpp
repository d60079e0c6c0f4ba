// Motors on CAN buses and a chain of links, made one device with six degrees of freedom.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "asperity/hal/articulated/articulated_config.hpp"
#include "asperity/hal/device.hpp"

namespace asperity {

/// Why an arm is in fault.
struct arm_fault {
  const char* what = "none";  ///< a literal
  int joint = -1;             ///< counted from 0; -1 where no one joint is the cause
  int bus = -1;
  std::uint32_t code = 0;  ///< of the drive or transport, 0 where there is none
};

/// A haptic device made of N joint drives on M buses.
///
/// write() puts J^T w on the joints, plus what holds the links against gravity and what the soft stops push; one scale
/// for all joints keeps each within its limit and the wrench in its direction. read() drains the buses, supervises, and
/// computes pose and velocity of the handle from the joints.
///
/// - Torque is there in armed and active only. In ready the drives measure and their power sections are off: an arm
///   without brakes or counterweights falls when it is disarmed.
/// - A fault of one joint is a fault of all: zero torque on every drive in the same call, latched with its cause. In
///   fault write() goes on to lead the drives to idle.
/// - write() keeps the drives' own watchdogs fed, and nothing else does: whoever stops calling it is stopped.
/// - open() and arm() tick by themselves while they wait. The application has to tick soon after arm().
/// - open() after clear_fault() also resets faults that the drives hold.
/// A moved-from device may only be destroyed.
/// @rt read, write and disarm are as safe as buses and drives
class articulated_device {
 public:
  using policy_tag = device_tag;

  [[nodiscard]] static result<articulated_device> make(articulated_config config) {
    if (result<void> good = check(config); !good) return good.error();
    return articulated_device(std::move(config));
  }

  articulated_device(articulated_device&&) = default;
  articulated_device& operator=(articulated_device&&) = delete;
  articulated_device(const articulated_device&) = delete;
  articulated_device& operator=(const articulated_device&) = delete;
  ~articulated_device() {
    if (!config_.joints.empty()) close();  // not moved from
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }
  /// Cause of the last fault; stays until the next open().
  [[nodiscard]] const arm_fault& fault() const noexcept { return fault_; }
  /// The cause in one sentence.
  [[nodiscard]] std::string fault_words() const;

  [[nodiscard]] result<void> open();
  [[nodiscard]] result<void> arm();
  [[nodiscard]] result<void> clear_fault();
  status disarm() noexcept;
  void close() noexcept;
  /// @return ok | backend_failed (a fault was found: see fault()) | not_ready
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;
  /// @return ok | backend_failed (a fault was found) | not_finite (not a finite wrench, or in a wrong frame: a fault) |
  ///         not_ready
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept;

  /// Angles as last read, rad.
  [[nodiscard]] const joint_vector& angles_rad() const noexcept { return angles_rad_; }
  /// What was sent last, N m, and the scale that the wrench had in it.
  [[nodiscard]] const shared_torques& torques() const noexcept { return torques_; }
  /// Largest wrench in any direction at the present angles.
  [[nodiscard]] wrench_room room() const noexcept {
    const chain_pose at = forward(config_.chain, angles_rad_);
    return room_for_wrench(config_.chain, at, own_torques(at, 1.0), limits_n_m_);
  }
  [[nodiscard]] const articulated_config& config() const noexcept { return config_; }

 private:
  static constexpr int most_frames_per_call = 512;  // a babbling node must not hold the tick

  explicit articulated_device(articulated_config config) : config_(std::move(config)) {
    capabilities_ = capabilities_of(config_);
    for (std::size_t i = 0; i < size(); ++i) {
      limits_n_m_[i] = torque_limit_n_m(config_.joints[i], config_.chain.joints[i]);
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return config_.joints.size(); }
  [[nodiscard]] joint_drive& drive(std::size_t i) const noexcept { return *config_.joints[i].drive; }
  [[nodiscard]] bool all_idle() const noexcept {
    for (std::size_t i = 0; i < size(); ++i) {
      if (drive(i).state() != drive_state::idle || drive(i).reading().sequence == 0) return false;
    }
    return true;
  }
  [[nodiscard]] bool measures() const noexcept {
    return machine_.state() == device_state::ready || may_put_out(machine_.state());
  }

  void note(const char* what, int joint, int bus, std::uint32_t code) noexcept {
    if (!has_fault_) fault_ = {what, joint, bus, code};
    has_fault_ = true;
  }
  void fail(const char* what, int joint, int bus, std::uint32_t code) noexcept;
  void fail_bus(std::size_t bus, io_status s) noexcept;
  void silence() noexcept;
  void wind_down() noexcept;
  void offer(std::size_t bus, const can_frame& frame) noexcept;
  [[nodiscard]] bool drain(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool supervise(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool step_drives(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool put_out(std::int64_t now_ns, const wrench& on_hand) noexcept;
  [[nodiscard]] joint_vector own_torques(const chain_pose& at, double gravity) const noexcept;
  [[nodiscard]] double gravity_share(std::int64_t now_ns) const noexcept;
  void advance(std::int64_t now_ns) noexcept { now_ns_ = std::max(now_ns_, now_ns); }
  template <class Done>
  [[nodiscard]] bool tick_until(std::int64_t limit_ns, Done&& done) noexcept;
  [[nodiscard]] result<void> refused(const char* what) const;
  [[nodiscard]] error failed(const char* what) const;

  articulated_config config_;
  device_capabilities capabilities_{};
  joint_vector limits_n_m_{};
  device_state_machine machine_{};
  arm_fault fault_{};
  bool has_fault_ = false;

  std::int64_t now_ns_ = 0;  // the newest time that anybody told
  std::int64_t armed_ns_ = 0;
  joint_vector angles_rad_{};
  joint_vector rates_rad_per_s_{};
  std::array<std::uint64_t, most_joints> seen_{};
  device_sample newest_{};
  device_command command_{};
  bool pushes_ = false;  // a wrench other than zero was sent
  shared_torques torques_{};
};

inline void articulated_device::fail(const char* what, int joint, int bus, std::uint32_t code) noexcept {
  note(what, joint, bus, code);
  machine_.apply(device_event::failed);
  silence();
}

inline void articulated_device::fail_bus(std::size_t bus, io_status s) noexcept {
  note(s == io_status::gone ? "the bus was unplugged (answer of the transport)"
                            : "the bus failed (answer of the transport)",
       -1, static_cast<int>(bus), static_cast<std::uint32_t>(s));
  machine_.apply(s == io_status::gone ? device_event::departed : device_event::failed);
  silence();
}

// Zero on every drive, at once and whatever the buses answer: the cause is known already.
inline void articulated_device::silence() noexcept {
  command_ = {};
  pushes_ = false;
  torques_ = {};
  for (std::size_t i = 0; i < size(); ++i) {
    drive(i).set_torque(0.0);
    drive(i).disable(now_ns_);
    static_cast<void>(drive(i).step(now_ns_, *config_.buses[config_.joints[i].bus].bus));
  }
  for (const arm_bus& b : config_.buses) {
    if (b.service != nullptr) static_cast<void>(b.service->step(now_ns_, *b.bus));
  }
}

// Leads the drives to idle, as far as the buses let us.
inline void articulated_device::wind_down() noexcept {
  for (std::size_t b = 0; b < config_.buses.size(); ++b) {
    can_frame frame;
    for (int k = 0; k < most_frames_per_call; ++k) {
      if (config_.buses[b].bus->receive(now_ns_, frame) != io_status::ok) break;
      offer(b, frame);
    }
  }
  silence();
}

inline void articulated_device::offer(std::size_t bus, const can_frame& frame) noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    if (config_.joints[i].bus == bus && drive(i).take(now_ns_, frame)) return;
  }
}

inline bool articulated_device::drain(std::int64_t now_ns) noexcept {
  for (std::size_t b = 0; b < config_.buses.size(); ++b) {
    can_bus& bus = *config_.buses[b].bus;
    can_frame frame;
    io_status s = io_status::ok;
    for (int k = 0; k < most_frames_per_call; ++k) {
      s = bus.receive(now_ns, frame);
      if (s != io_status::ok) break;
      offer(b, frame);
    }
    if (s != io_status::ok && s != io_status::nothing) {
      fail_bus(b, s);
      return false;
    }
    if (bus.health().bus_off) {
      fail_bus(b, io_status::down);
      return false;
    }
  }
  return true;
}

// Judges what the drives say. In open() this begins when all of them are idle.
inline bool articulated_device::supervise(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    const int joint = static_cast<int>(i);
    const joint_drive& d = drive(i);
    if (d.state() == drive_state::fault) {
      fail(d.fault().what, joint, static_cast<int>(config_.joints[i].bus), d.fault().code);
      return false;
    }
    const joint_reading& r = d.reading();
    if (!std::isfinite(r.position_rad) || !std::isfinite(r.velocity_rad_per_s)) {
      fail("the joint's angle or speed is not finite", joint, -1, 0);
      return false;
    }
    if (r.sequence != 0) angles_rad_[i] = r.position_rad;
    rates_rad_per_s_[i] = r.has_velocity ? r.velocity_rad_per_s : 0.0;
    if (!measures()) continue;

    const chain_joint& j = config_.chain.joints[i];
    if (now_ns - r.host_time_ns > config_.reading_limit_ns) {
      fail("the joint's reading is too old", joint, -1, 0);
      return false;
    }
    if (angles_rad_[i] < j.lower_rad - config_.stop.overrun_rad ||
        angles_rad_[i] > j.upper_rad + config_.stop.overrun_rad) {
      fail("the joint is beyond its limits: its zero is wrong, or its stop is broken", joint, -1, 0);
      return false;
    }
    if (std::fabs(rates_rad_per_s_[i]) > config_.joints[i].max_speed_rad_per_s) {
      fail("the joint is faster than its limit", joint, -1, 0);
      return false;
    }
    if (may_put_out(machine_.state()) && d.state() != drive_state::enabled) {
      fail("the drive is not enabled any more", joint, -1, 0);
      return false;
    }
  }
  return true;
}

inline bool articulated_device::step_drives(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    const std::size_t b = config_.joints[i].bus;
    const io_status s = drive(i).step(now_ns, *config_.buses[b].bus);
    if (s != io_status::ok && s != io_status::busy) {
      fail_bus(b, s);
      return false;
    }
    if (drive(i).state() == drive_state::fault) {
      fail(drive(i).fault().what, static_cast<int>(i), static_cast<int>(b), drive(i).fault().code);
      return false;
    }
  }
  for (std::size_t b = 0; b < config_.buses.size(); ++b) {
    if (config_.buses[b].service == nullptr) continue;
    const io_status s = config_.buses[b].service->step(now_ns, *config_.buses[b].bus);
    if (s != io_status::ok && s != io_status::busy) {
      fail_bus(b, s);
      return false;
    }
  }
  return true;
}

inline joint_vector articulated_device::own_torques(const chain_pose& at, double gravity) const noexcept {
  joint_vector own{};
  if (config_.gravity_compensation) own = torques_against_gravity(config_.chain, at);
  const soft_stop& s = config_.stop;
  for (std::size_t i = 0; i < size(); ++i) {
    own[i] *= gravity;
    const chain_joint& j = config_.chain.joints[i];
    const double over = angles_rad_[i] - (j.upper_rad - s.zone_rad);
    const double under = (j.lower_rad + s.zone_rad) - angles_rad_[i];
    const double rate = rates_rad_per_s_[i];
    if (over > 0.0) own[i] -= s.stiffness_n_m_per_rad * over + s.damping_n_m_s_per_rad * std::max(0.0, rate);
    if (under > 0.0) own[i] += s.stiffness_n_m_per_rad * under + s.damping_n_m_s_per_rad * std::max(0.0, -rate);
  }
  return own;
}

inline double articulated_device::gravity_share(std::int64_t now_ns) const noexcept {
  if (config_.gravity_ramp_ns <= 0) return 1.0;
  return std::clamp(static_cast<double>(now_ns - armed_ns_) / static_cast<double>(config_.gravity_ramp_ns), 0.0, 1.0);
}

/// @pre may_put_out(state())
inline bool articulated_device::put_out(std::int64_t now_ns, const wrench& on_hand) noexcept {
  const chain_pose at = forward(config_.chain, angles_rad_);
  torques_ = share_torques(size(), own_torques(at, gravity_share(now_ns)), torques_for(config_.chain, at, on_hand),
                           limits_n_m_);
  if (!torques_.finite) {
    fail("the joint torques of the wrench are not finite", -1, -1, 0);
    return false;
  }
  for (std::size_t i = 0; i < size(); ++i) drive(i).set_torque(torques_.torque_n_m[i]);
  pushes_ = on_hand.force != vec3(0.0) || on_hand.torque != vec3(0.0);
  return step_drives(now_ns);
}

inline status articulated_device::read(std::int64_t now_ns, device_sample& in) noexcept {
  advance(now_ns);
  if (!measures()) return status::not_ready;
  if (!drain(now_ns_) || !supervise(now_ns_)) return status::backend_failed;
  // The application reads but does not write: its last wrench runs out here.
  if (pushes_ && now_ns_ > command_.valid_until_ns && !put_out(now_ns_, {})) return status::backend_failed;

  // A measurement is complete when every joint has moved on.
  bool complete = true;
  std::int64_t oldest_ns = now_ns_;
  std::uint64_t lost = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    complete = complete && drive(i).reading().sequence != seen_[i];
    oldest_ns = std::min(oldest_ns, drive(i).reading().host_time_ns);
  }
  for (const arm_bus& b : config_.buses) lost += b.bus->health().lost;
  if (complete) {
    for (std::size_t i = 0; i < size(); ++i) seen_[i] = drive(i).reading().sequence;
    const chain_pose at = forward(config_.chain, angles_rad_);
    newest_.host_time_ns = oldest_ns;
    newest_.device_time_ns = oldest_ns;
    ++newest_.sequence;
    newest_.lost = lost;
    newest_.T_dh = at.T_dh;
    newest_.velocity_d = handle_velocity(config_.chain, at, rates_rad_per_s_);
    newest_.valid = sample_field::position | sample_field::rotation | sample_field::linear_velocity |
                    sample_field::angular_velocity;
  }
  in = newest_;
  return status::ok;
}

inline status articulated_device::write(std::int64_t now_ns, const device_command& out) noexcept {
  advance(now_ns);
  if (machine_.state() == device_state::fault) {
    wind_down();
    return status::not_ready;
  }
  if (!measures()) return status::not_ready;
  if (machine_.state() == device_state::ready) {
    for (std::size_t i = 0; i < size(); ++i) drive(i).set_torque(0.0);
    torques_ = {};
    return step_drives(now_ns_) ? status::ok : status::backend_failed;
  }
  if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
    fail("a command was not finite, or not written in the device's base frame", -1, -1, 0);
    return status::not_finite;
  }
  const bool fresh = now_ns_ <= out.valid_until_ns;
  const wrench on_hand = fresh ? out.on_hand : wrench{};
  const bool zero = on_hand.force == vec3(0.0) && on_hand.torque == vec3(0.0);
  machine_.apply(zero ? device_event::released : device_event::engaged);
  command_ = out;
  return put_out(now_ns_, on_hand) ? status::ok : status::backend_failed;
}

// Ticks until done() or the limit; false where a fault came or time ran out.
template <class Done>
inline bool articulated_device::tick_until(std::int64_t limit_ns, Done&& done) noexcept {
  io_clock& clock = *config_.clock;
  advance(clock.now_ns());
  const std::int64_t end_ns = now_ns_ + limit_ns;
  while (now_ns_ < end_ns) {
    if (!drain(now_ns_) || !supervise(now_ns_)) return false;
    if (done()) return true;
    if (!step_drives(now_ns_)) return false;
    clock.wait_until_ns(now_ns_ + config_.period_ns);
    advance(clock.now_ns());
  }
  return false;
}

inline std::string articulated_device::fault_words() const {
  std::string out;
  if (fault_.joint >= 0)
    out = "joint " + std::to_string(fault_.joint + 1) + ": ";
  else if (fault_.bus >= 0)
    out = "bus " + std::to_string(fault_.bus + 1) + ": ";
  out += fault_.what;
  if (fault_.code != 0) {
    constexpr const char* digits = "0123456789abcdef";
    std::string hex = "00000000";
    for (std::size_t i = 0; i < 8; ++i) hex[7 - i] = digits[(fault_.code >> (4 * i)) & 0xf];
    out += " (code 0x" + hex + ")";
  }
  return out;
}

inline result<void> articulated_device::refused(const char* what) const {
  return error{error_code::invalid_argument,
               std::string(what) + "() is not possible while the arm is " + to_string(machine_.state())};
}

inline error articulated_device::failed(const char* what) const {
  return {error_code::io_failed, std::string(what) + "() of the arm failed: " + fault_words()};
}

inline result<void> articulated_device::open() {
  if (machine_.state() == device_state::absent || machine_.state() == device_state::closed) {
    machine_.apply(device_event::arrived);
  }
  if (!machine_.apply(device_event::opened)) return refused("open");
  has_fault_ = false;
  fault_ = {};
  advance(config_.clock->now_ns());
  for (std::size_t i = 0; i < size(); ++i) drive(i).start(now_ns_);
  if (!tick_until(config_.open_limit_ns, [this] { return all_idle(); })) {
    if (!has_fault_) fail("the drives did not all become idle in time", -1, -1, 0);
    return failed("open");
  }
  machine_.apply(device_event::prepared);
  if (!supervise(now_ns_)) return failed("open");
  newest_.valid = sample_field::none;
  return {};
}

inline result<void> articulated_device::arm() {
  if (machine_.state() != device_state::ready) return refused("arm");
  advance(config_.clock->now_ns());
  // After a disarm() the drives are on their way to idle for some periods.
  if (!tick_until(config_.arm_limit_ns, [this] { return all_idle(); })) {
    if (!has_fault_) fail("the drives did not all become idle in time", -1, -1, 0);
    return failed("arm");
  }
  for (std::size_t i = 0; i < size(); ++i) {
    drive(i).set_torque(0.0);
    if (!drive(i).enable(now_ns_)) {
      fail("the drive was not idle when it was to be enabled", static_cast<int>(i), -1, 0);
      return failed("arm");
    }
  }
  const auto all_enabled = [this] {
    for (std::size_t i = 0; i < size(); ++i) {
      if (drive(i).state() != drive_state::enabled) return false;
    }
    return true;
  };
  if (!tick_until(config_.arm_limit_ns, all_enabled)) {
    if (!has_fault_) fail("the drives were not all enabled in time", -1, -1, 0);
    return failed("arm");
  }
  armed_ns_ = now_ns_;
  command_ = {};
  machine_.apply(device_event::armed);
  return {};
}

inline result<void> articulated_device::clear_fault() {
  if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
  advance(config_.clock->now_ns());
  for (std::size_t i = 0; i < size(); ++i) {
    if (drive(i).state() == drive_state::fault) static_cast<void>(drive(i).clear_fault(now_ns_));
  }
  return {};
}

inline status articulated_device::disarm() noexcept {
  const bool allowed = machine_.apply(device_event::disarmed);
  silence();
  return allowed ? status::ok : status::not_ready;
}

inline void articulated_device::close() noexcept {
  constexpr int most_ticks = 100;
  const bool was_open = machine_.state() != device_state::absent && machine_.state() != device_state::closed &&
                        machine_.state() != device_state::present;
  if (!was_open) return;
  machine_.apply(device_event::disarmed);
  silence();
  // The drives switch their power sections off before their supervision of us ends.
  io_clock& clock = *config_.clock;
  for (int k = 0; k < most_ticks; ++k) {
    bool all_off = true;
    for (std::size_t i = 0; i < size(); ++i) {
      const drive_state s = drive(i).state();
      all_off = all_off && s != drive_state::enabled && s != drive_state::starting;
    }
    if (all_off) break;
    clock.wait_until_ns(clock.now_ns() + config_.period_ns);
    advance(clock.now_ns());
    wind_down();
  }
  for (const arm_bus& b : config_.buses) {
    if (b.service != nullptr) b.service->finish(now_ns_, *b.bus);
  }
  machine_.apply(device_event::closed);
}

static_assert(haptic_device<articulated_device>);

}  // namespace asperity
