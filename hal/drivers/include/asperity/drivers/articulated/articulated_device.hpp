// Motors on CAN buses and a chain of links, made one device with six degrees of freedom.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "asperity/device/device.hpp"
#include "asperity/drivers/articulated/articulated_settings.hpp"
#include "asperity/drivers/articulated/drive_group.hpp"

namespace asperity {

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

  [[nodiscard]] static result<articulated_device> make(articulated_settings settings) {
    if (result<void> good = check(settings); !good) return good.error();
    return articulated_device(std::move(settings));
  }

  articulated_device(articulated_device&&) = default;
  articulated_device& operator=(articulated_device&&) = delete;
  articulated_device(const articulated_device&) = delete;
  articulated_device& operator=(const articulated_device&) = delete;
  ~articulated_device() {
    if (!settings_.joints.empty()) close();  // not moved from
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }
  /// Cause of the last fault; stays until the next open().
  [[nodiscard]] const arm_fault& fault() const noexcept { return fault_; }
  /// The cause in one sentence.
  [[nodiscard]] std::string fault_words() const { return to_words(fault_); }

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
    const chain_pose at = forward(settings_.chain, angles_rad_);
    return room_for_wrench(settings_.chain, at, own_torques(at, 1.0), limits_n_m_);
  }
  [[nodiscard]] const articulated_settings& settings() const noexcept { return settings_; }

 private:
  explicit articulated_device(articulated_settings settings)
      : settings_(std::move(settings)), drives_(settings_.joints, settings_.buses) {
    capabilities_ = capabilities_of(settings_);
    for (std::size_t i = 0; i < size(); ++i) {
      limits_n_m_[i] = torque_limit_n_m(settings_.joints[i], settings_.chain.joints[i]);
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return settings_.joints.size(); }
  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  void silence() noexcept;
  void fail(const arm_fault& fault) noexcept;
  void fail(const char* what, int joint = -1) noexcept { fail(arm_fault{.what = what, .joint = joint}); }
  [[nodiscard]] bool well(const std::optional<arm_fault>& fault) noexcept {
    if (fault) fail(*fault);
    return !fault;
  }
  [[nodiscard]] bool supervise() noexcept;
  [[nodiscard]] bool put_out(const wrench& on_hand) noexcept;
  [[nodiscard]] joint_vector own_torques(const chain_pose& at, double gravity) const noexcept;
  [[nodiscard]] double gravity_share() const noexcept;
  void advance(std::int64_t now_ns) noexcept { now_ns_ = std::max(now_ns_, now_ns); }
  template <class Done>
  [[nodiscard]] bool tick_until(std::int64_t limit_ns, Done&& done, const char* late) noexcept;
  [[nodiscard]] result<void> refused(const char* what) const;
  [[nodiscard]] error failed(const char* what) const;

  articulated_settings settings_;
  drive_group drives_;  // looks at joints and buses of settings_, which stay where they are when the device moves
  device_capabilities capabilities_{};
  joint_vector limits_n_m_{};
  device_state_machine machine_{};
  arm_fault fault_{};
  bool has_fault_ = false;

  std::int64_t now_ns_ = 0;  // the newest time that anybody told
  std::int64_t armed_ns_ = 0;
  joint_vector angles_rad_{};
  joint_vector rates_rad_per_s_{};
  device_sample newest_{};
  device_command command_{};
  bool pushes_ = false;  // a wrench other than zero was sent
  shared_torques torques_{};
};

inline void articulated_device::fail(const arm_fault& fault) noexcept {
  if (!has_fault_) fault_ = fault;
  has_fault_ = true;
  machine_.apply(fault.departed ? device_event::departed : device_event::failed);
  silence();
}

inline void articulated_device::silence() noexcept {
  command_ = {};
  pushes_ = false;
  torques_ = {};
  drives_.silence(now_ns_);
}

// Judges what the drives say. In open() this begins when all of them are idle.
inline bool articulated_device::supervise() noexcept {
  const auto wrong = [this](const char* what, std::size_t joint) {
    fail(what, static_cast<int>(joint));
    return false;
  };
  for (std::size_t i = 0; i < size(); ++i) {
    const joint_drive& d = drives_[i];
    if (d.state() == drive_state::fault) return well(drives_.fault_of_drive(i));
    const joint_reading& r = d.reading();
    if (!std::isfinite(r.position_rad) || !std::isfinite(r.velocity_rad_per_s)) {
      return wrong("the joint's angle or speed is not finite", i);
    }
    if (r.sequence != 0) angles_rad_[i] = r.position_rad;
    rates_rad_per_s_[i] = r.has_velocity ? r.velocity_rad_per_s : 0.0;
    if (!measures()) continue;

    const chain_joint& j = settings_.chain.joints[i];
    if (now_ns_ - r.host_time_ns > settings_.reading_limit_ns) return wrong("the joint's reading is too old", i);
    if (angles_rad_[i] < j.lower_rad - settings_.stop.overrun_rad ||
        angles_rad_[i] > j.upper_rad + settings_.stop.overrun_rad) {
      return wrong("the joint is beyond its limits: its zero is wrong, or its stop is broken", i);
    }
    if (std::fabs(rates_rad_per_s_[i]) > settings_.joints[i].max_speed_rad_per_s) {
      return wrong("the joint is faster than its limit", i);
    }
    if (may_put_out(machine_.state()) && d.state() != drive_state::enabled) {
      return wrong("the drive is not enabled any more", i);
    }
  }
  return true;
}

inline joint_vector articulated_device::own_torques(const chain_pose& at, double gravity) const noexcept {
  joint_vector own{};
  if (settings_.gravity_compensation) own = torques_against_gravity(settings_.chain, at);
  for (std::size_t i = 0; i < size(); ++i) {
    own[i] =
        with_stop(gravity * own[i], settings_.stop, settings_.chain.joints[i], angles_rad_[i], rates_rad_per_s_[i]);
  }
  return own;
}

inline double articulated_device::gravity_share() const noexcept {
  if (settings_.gravity_ramp_ns <= 0) return 1.0;
  return std::clamp(static_cast<double>(now_ns_ - armed_ns_) / static_cast<double>(settings_.gravity_ramp_ns), 0.0,
                    1.0);
}

/// @pre may_put_out(state())
inline bool articulated_device::put_out(const wrench& on_hand) noexcept {
  const chain_pose at = forward(settings_.chain, angles_rad_);
  torques_ =
      share_torques(size(), own_torques(at, gravity_share()), torques_for(settings_.chain, at, on_hand), limits_n_m_);
  if (!torques_.finite) {
    fail("the joint torques of the wrench are not finite");
    return false;
  }
  drives_.set_torques(torques_.torque_n_m);
  pushes_ = on_hand.force != vec3(0.0) || on_hand.torque != vec3(0.0);
  return well(drives_.step(now_ns_));
}

inline status articulated_device::read(std::int64_t now_ns, device_sample& in) noexcept {
  advance(now_ns);
  if (!measures()) return status::not_ready;
  if (!well(drives_.drain(now_ns_)) || !supervise()) return status::backend_failed;
  // The application reads but does not write: its last wrench runs out here.
  if (pushes_ && now_ns_ > command_.valid_until_ns && !put_out({})) return status::backend_failed;

  // A measurement is complete when every joint has moved on.
  if (drives_.measured_anew()) {
    const chain_pose at = forward(settings_.chain, angles_rad_);
    const std::int64_t oldest_ns = drives_.oldest_reading_ns(now_ns_);
    newest_.host_time_ns = oldest_ns;
    newest_.device_time_ns = oldest_ns;
    ++newest_.sequence;
    newest_.lost = drives_.lost();
    newest_.T_dh = at.T_dh;
    newest_.velocity_d = handle_velocity(settings_.chain, at, rates_rad_per_s_);
    newest_.valid = sample_field::position | sample_field::rotation | sample_field::linear_velocity |
                    sample_field::angular_velocity;
  }
  in = newest_;
  return status::ok;
}

inline status articulated_device::write(std::int64_t now_ns, const device_command& out) noexcept {
  advance(now_ns);
  if (machine_.state() == device_state::fault) {
    drives_.wind_down(now_ns_);
    return status::not_ready;
  }
  if (!measures()) return status::not_ready;
  if (machine_.state() == device_state::ready) {
    drives_.set_torques({});
    torques_ = {};
    return well(drives_.step(now_ns_)) ? status::ok : status::backend_failed;
  }
  if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
    fail("a command was not finite, or not written in the device's base frame");
    return status::not_finite;
  }
  const bool fresh = now_ns_ <= out.valid_until_ns;
  const wrench on_hand = fresh ? out.on_hand : wrench{};
  const bool zero = is_zero(on_hand);
  machine_.apply(zero ? device_event::released : device_event::engaged);
  command_ = out;
  return put_out(on_hand) ? status::ok : status::backend_failed;
}

// Ticks until done(); false where a fault came, of which one is that time ran out.
template <class Done>
inline bool articulated_device::tick_until(std::int64_t limit_ns, Done&& done, const char* late) noexcept {
  io_clock& clock = *settings_.clock;
  advance(clock.now_ns());
  const std::int64_t end_ns = now_ns_ + limit_ns;
  while (now_ns_ < end_ns) {
    if (!well(drives_.drain(now_ns_)) || !supervise()) return false;
    if (done()) return true;
    if (!well(drives_.step(now_ns_))) return false;
    clock.wait_until_ns(now_ns_ + settings_.period_ns);
    advance(clock.now_ns());
  }
  fail(late);
  return false;
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
  advance(settings_.clock->now_ns());
  drives_.start(now_ns_);
  const auto idle = [this] { return drives_.all_idle(); };
  if (!tick_until(settings_.open_limit_ns, idle, "the drives did not all become idle in time")) return failed("open");
  machine_.apply(device_event::prepared);
  if (!supervise()) return failed("open");
  newest_.valid = sample_field::none;
  return {};
}

inline result<void> articulated_device::arm() {
  if (machine_.state() != device_state::ready) return refused("arm");
  advance(settings_.clock->now_ns());
  // After a disarm() the drives are on their way to idle for some periods.
  const auto idle = [this] { return drives_.all_idle(); };
  const auto enabled = [this] { return drives_.all_enabled(); };
  if (!tick_until(settings_.arm_limit_ns, idle, "the drives did not all become idle in time")) return failed("arm");
  if (!well(drives_.enable(now_ns_))) return failed("arm");
  if (!tick_until(settings_.arm_limit_ns, enabled, "the drives were not all enabled in time")) return failed("arm");
  armed_ns_ = now_ns_;
  command_ = {};
  machine_.apply(device_event::armed);
  return {};
}

inline result<void> articulated_device::clear_fault() {
  if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
  advance(settings_.clock->now_ns());
  drives_.clear_faults(now_ns_);
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
  io_clock& clock = *settings_.clock;
  for (int k = 0; k < most_ticks && !drives_.none_on(); ++k) {
    clock.wait_until_ns(clock.now_ns() + settings_.period_ns);
    advance(clock.now_ns());
    drives_.wind_down(now_ns_);
  }
  drives_.finish(now_ns_);
  machine_.apply(device_event::closed);
}

static_assert(haptic_device<articulated_device>);

}  // namespace asperity
