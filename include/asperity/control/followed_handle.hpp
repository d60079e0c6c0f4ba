// The handle as a device loop follows it: where it is in the world, how fast it moves, and what is held down on it.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "asperity/control/control_settings.hpp"
#include "asperity/control/session_record.hpp"
#include "asperity/control/workspace_map.hpp"
#include "asperity/device/device.hpp"

namespace asperity {

/// A device's handle, from one accepted sample to the next. @rt safe
class followed_handle {
 public:
  /// @param T_hc the probe's centre-of-mass frame on the handle
  followed_handle(const control_settings& settings, const device_capabilities& device, const pose& T_hc) noexcept
      : lets_go_(settings.clutch),
        T_hc_(T_hc),
        clutch_(settings.map, settings.clutch),
        speed_(settings.velocity, device.position_resolution_m, device.rotation_resolution_rad) {}

  /// The sample that was accepted last. A device fills in what it tells: a new sample begins as a copy of this one.
  [[nodiscard]] const device_sample& last() const noexcept { return last_; }
  void take(const device_sample& accepted) noexcept { last_ = accepted; }

  /// Follows the last sample for dt_s seconds. @param by_application the application wants the probe let go
  /// @return whether the clutch has just let go, or begins to take up: then put() may be called
  [[nodiscard]] bool follow(bool by_application, double dt_s) noexcept {
    speed_.observe(last_);
    if (has_all(last_.valid, sample_field::buttons)) buttons_ = last_.buttons;
    const bool asked = lets_go_.by_application && by_application;
    return clutch_.follow(last_.T_dh, asked || (buttons_ & lets_go_.buttons) != 0, dt_s);
  }
  /// The probe is in the hand, where the handle is now.
  void take_up() noexcept { clutch_.take_up(last_.T_dh); }
  /// Puts the handle where the probe has its centre-of-mass frame. @pre follow() returned true
  void put(const pose& T_wc) noexcept { clutch_.put(T_wc * inverse(T_hc_)); }
  /// Nothing is known of its speed any more.
  void restart() noexcept { speed_.restart(); }

  /// Where the handle wants the probe's centre-of-mass frame.
  [[nodiscard]] pose T_wc() const noexcept { return clutch_.T_wh() * T_hc_; }
  /// Of that frame's origin; nothing where its way is to tell.
  [[nodiscard]] std::optional<twist> velocity_of(const pose& wanted_T_wc) const noexcept {
    if (speed_.used() == velocity_source::poses) return std::nullopt;
    twist v = clutch_.to_world(speed_.velocity_d());
    v.linear += glm::cross(v.angular, wanted_T_wc.position - clutch_.T_wh().position);
    return v;
  }

  /// Where it is in the world, and how much of it the probe has.
  [[nodiscard]] const clutched_map& clutch() const noexcept { return clutch_; }
  /// How fast it moves, and who says so.
  [[nodiscard]] const velocity_estimator& speed() const noexcept { return speed_; }

  /// Its part of a record.
  void tell(session_record& r) noexcept {
    r.T_dh = last_.T_dh;
    r.buttons = buttons_;
    r.buttons_told = has_all(last_.valid, sample_field::buttons);
    r.gripper_told = has_all(last_.valid, sample_field::gripper) && std::isfinite(last_.gripper_m);
    if (r.gripper_told) gripper_m_ = last_.gripper_m;
    r.gripper_m = gripper_m_;
    r.clutch_ratio = clutch_.ratio();
    r.velocity = speed_.used();
    r.velocity_refused = speed_.refused();
  }

 private:
  clutch_settings lets_go_;
  pose T_hc_;
  clutched_map clutch_;
  velocity_estimator speed_;
  device_sample last_{};
  double gripper_m_ = 0.0;
  std::uint32_t buttons_ = 0;  // as last told
};

}  // namespace asperity
