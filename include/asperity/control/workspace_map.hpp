// From the device's handle to the probe, and back from the probe's wrench to the hand.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "asperity/control/session_record.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/device/device.hpp"
#include "asperity/device/sample_check.hpp"

namespace asperity {

/// Where the device's workspace lies in the world: p_w = T_wd * (scale * p_d). The default is the identity.
/// The handle frame h carries the probe's body frame a at T_ha. Rotations are not scaled.
/// The map is a lossless transformer: the power F . v + T . w is the same on both sides, so a passive probe is a
/// passive device. A scale of 2 doubles motions in the world, and doubles the force on the hand.
struct workspace_map {
  pose T_wd{};
  double scale = 1.0;  ///< > 0, metres in the world for a metre of the device
  pose T_ha{};

  /// Pose of the handle in the world.
  /// @rt safe
  [[nodiscard]] pose to_world(const pose& T_dh) const noexcept {
    return {T_wd.rotation * T_dh.rotation, T_wd * (scale * T_dh.position)};
  }

  /// The handle's pose in the device's base frame, where it has this one in the world.
  /// @rt safe
  [[nodiscard]] pose handle_at(const pose& T_wh) const noexcept {
    return {glm::conjugate(T_wd.rotation) * T_wh.rotation, (1.0 / scale) * (inverse(T_wd) * T_wh.position)};
  }

  /// Velocity of the handle's origin in the world.
  /// @rt safe
  [[nodiscard]] twist to_world(const twist& velocity_d) const noexcept {
    return {T_wd.rotation * (scale * velocity_d.linear), T_wd.rotation * velocity_d.angular};
  }

  /// Wrench on the hand: axes of d, torque about the handle's origin, from one in world axes about point_w.
  /// @param handle_w origin of the handle in the world, as to_world() gives it
  /// @rt safe
  [[nodiscard]] wrench to_device(const wrench& on_hand_w, const vec3& point_w, const vec3& handle_w) const noexcept {
    const wrench about_handle = transport(on_hand_w, point_w, handle_w);
    const quat r_dw = glm::conjugate(T_wd.rotation);
    return {r_dw * (scale * about_handle.force), r_dw * about_handle.torque};
  }
};

/// How a handle lets go of its probe, so that a hand can be put elsewhere and go on. None by default.
struct clutch_settings {
  std::uint32_t buttons = 0;    ///< one bit per button: while any of these is held down the handle has let go
  bool by_application = false;  ///< exchange::let_go does the same
  double ramp_s = 0.15;         ///< for which the probe is let go or taken up; below 0.02 s, 0.02 s

  [[nodiscard]] bool any() const noexcept { return buttons != 0 || by_application; }
};

/// A workspace map with a clutch: the handle's motion is given to the probe in the proportion `ratio`, and the wrench to
/// the hand in the same, so that at any ratio the power is the same on both sides. The ratio goes from 1 to 0 or back in
/// a ramp.
///
/// The ratio with which a wrench was sent is the one with which the motion is taken that follows on it: for a wrench that
/// is held between two samples the work is the same on both sides, to rounding.
/// Without a clutch, and with the ratio at 1, the handle is where the map puts it, moved by what the clutch has moved it
/// so far: nothing drifts.
/// @rt safe
class clutched_map {
 public:
  explicit clutched_map(const workspace_map& map, const clutch_settings& settings = {}) noexcept
      : map_(map), used_(settings.any()), ramp_s_(settings.ramp_s > 0.02 ? settings.ramp_s : 0.02) {}

  /// The handle is here now, and what it moves stays where it is in the world; before the first call, where the map puts
  /// it. The probe is in the hand.
  void take_up(const pose& T_dh) noexcept {
    if (follows_ && ratio_ < 1.0) keep_place(T_dh);
    ratio_ = 1.0;
    follows_ = true;
    last_T_dh_ = T_dh;
    T_wh_ = whole(T_dh);
  }

  /// One device tick of dt_s seconds, at whose end the handle is here.
  /// @return whether it has just let go, or begins to take up: then nothing is felt, and put() may be called
  bool follow(const pose& T_dh, bool let_go, double dt_s) noexcept {
    if (!used_ || !follows_) {
      T_wh_ = whole(T_dh);
      last_T_dh_ = T_dh;
      return false;
    }
    if (ratio_ < 1.0) {
      const vec3 moved_d = T_dh.position - last_T_dh_.position;
      const vec3 turned_d = log_rotation(T_dh.rotation * glm::conjugate(last_T_dh_.rotation));
      const twist moved_w = to_world({moved_d, turned_d});
      T_wh_ = {glm::normalize(exp_rotation(moved_w.angular) * T_wh_.rotation), T_wh_.position + moved_w.linear};
    } else {
      T_wh_ = whole(T_dh);
    }
    last_T_dh_ = T_dh;
    const double before = ratio_;
    const double step = dt_s / ramp_s_;
    ratio_ = let_go ? std::max(0.0, ratio_ - step) : std::min(1.0, ratio_ + step);
    if (before < 1.0 && ratio_ >= 1.0) keep_place(T_dh);
    return (ratio_ > 0.0) != (before > 0.0);
  }

  /// Puts the handle elsewhere in the world, where nothing is felt of it. @pre follow() returned true
  void put(const pose& T_wh) noexcept { T_wh_ = T_wh; }

  /// The handle in the world, as far as the probe has it.
  [[nodiscard]] const pose& T_wh() const noexcept { return T_wh_; }
  /// Velocity of the handle's origin in the world.
  [[nodiscard]] twist to_world(const twist& velocity_d) const noexcept {
    const twist v = map_.to_world(velocity_d);
    return {ratio_ * v.linear, ratio_ * v.angular};
  }
  /// Wrench on the hand: axes of d, torque about the handle's origin, from one in world axes about point_w.
  [[nodiscard]] wrench to_device(const wrench& on_hand_w, const vec3& point_w) const noexcept {
    return ratio_ * map_.to_device(on_hand_w, point_w, T_wh_.position);
  }
  /// 1: the probe is in the hand; 0: the hand has let go.
  [[nodiscard]] double ratio() const noexcept { return ratio_; }

 private:
  // Where the map puts the handle, moved by moved_w_ and turned in itself by turned_h_.
  [[nodiscard]] pose whole(const pose& T_dh) const noexcept {
    const pose mapped = map_.to_world(T_dh);
    return moved_ ? pose{mapped.rotation * turned_h_, mapped.position + moved_w_} : mapped;
  }
  // From now on whole() gives the present place.
  void keep_place(const pose& T_dh) noexcept {
    const pose mapped = map_.to_world(T_dh);
    turned_h_ = glm::normalize(glm::conjugate(mapped.rotation) * T_wh_.rotation);
    moved_w_ = T_wh_.position - mapped.position;
    moved_ = true;
  }

  workspace_map map_;
  bool used_;
  double ramp_s_;
  double ratio_ = 1.0;
  bool follows_ = false;
  bool moved_ = false;
  pose last_T_dh_{};
  pose T_wh_{};
  quat turned_h_{1.0, 0.0, 0.0, 0.0};
  vec3 moved_w_{0.0};
};

/// A device's handle, from one accepted sample to the next. @rt safe
class followed_handle {
 public:
  /// @param T_hc the probe's centre-of-mass frame on the handle
  followed_handle(const workspace_map& map, const clutch_settings& clutch, velocity_source velocity,
                  const device_capabilities& device, const pose& T_hc) noexcept
      : lets_go_(clutch),
        T_hc_(T_hc),
        clutch_(map, clutch),
        speed_(velocity, device.position_resolution_m, device.rotation_resolution_rad) {}

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
