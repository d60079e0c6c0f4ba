// Motors on CAN buses and a chain of links, made one device with six degrees of freedom.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "asperity/core/export.hpp"
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
///   fault write() goes on leading the drives to idle.
/// - Only write() feeds the drives' own watchdogs: when it is no longer called, the drives stop.
/// - open() and arm() tick the drives while they wait. The application has to tick soon after arm().
/// - open() after clear_fault() also resets faults that the drives hold.
/// A moved-from device may only be destroyed.
/// @rt read, write and disarm are as safe as buses and drives
class ASPERITY_API articulated_device {
 public:
  using policy_tag = device_tag;

  [[nodiscard]] static result<articulated_device> make(articulated_settings settings);
  articulated_device(articulated_device&&) = default;
  articulated_device& operator=(articulated_device&&) = delete;
  articulated_device(const articulated_device&) = delete;
  articulated_device& operator=(const articulated_device&) = delete;
  ~articulated_device();

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
  [[nodiscard]] wrench_room room() const noexcept;
  [[nodiscard]] const articulated_settings& settings() const noexcept { return settings_; }

 private:
  explicit articulated_device(articulated_settings settings);
  [[nodiscard]] std::size_t size() const noexcept { return settings_.joints.size(); }
  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  void silence() noexcept;
  void fail(const arm_fault& fault) noexcept;
  void fail(const char* what, int joint = -1) noexcept { fail(arm_fault{.what = what, .joint = joint}); }
  [[nodiscard]] bool well(const std::optional<arm_fault>& fault) noexcept;
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

  std::int64_t now_ns_ = 0;  // the newest time that a call was given
  std::int64_t armed_ns_ = 0;
  joint_vector angles_rad_{};
  joint_vector rates_rad_per_s_{};
  device_sample newest_{};
  device_command command_{};
  bool pushes_ = false;  // a wrench other than zero was sent
  shared_torques torques_{};
};

static_assert(haptic_device<articulated_device>);

}  // namespace asperity
