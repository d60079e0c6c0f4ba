// The safety net at the device's port: what the hand gets back may not exceed what it put in.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/device/capabilities.hpp"

namespace asperity {

struct guard_settings {
  bool enabled = true;
  /// Apparent mass and inertia of the device's handle: they set and bound the damping. Where both are zero a
  /// device_loop takes what the device states of itself; a guard by itself then adds no damping and only scales.
  double mass_kg = 0.0;
  double inertia_kg_m2 = 0.0;
  double tolerance_j = 1e-5;    ///< surplus that is left alone: one newton over one hundredth of a millimetre
  double credit_j = 0.1;        ///< most of the hand's energy that counts as lent to the loop
  double soft_limit_j = 0.005;  ///< surplus at which the wrench begins to be scaled down ...
  double hard_limit_j = 0.02;   ///< ... and at which only damping is left
  /// Most power of moving bodies that counts as theirs and not as the loop's, W. What they give beyond it is a surplus.
  double bodies_power_w = 5.0;
  double cut_off_j = 0.1;  ///< surplus at which damping has failed as well: a device_loop then shuts the gate
};

/// What the guard did in one tick.
struct guard_action {
  wrench on_hand{};          ///< the adjusted wrench
  double alpha_per_s = 0.0;  ///< damping rate that was added; exactly 0 where nothing had to be done
  double scale = 1.0;        ///< factor on the wanted wrench; exactly 1 where nothing had to be done
};

/// Passivity observer and controller of one device port, translation and rotation in one energy book.
///
/// Observer: for a wrench that is held between samples, the energy delivered to the hand in one sample is exactly
/// F_prev . dx + T_prev . log(R R_prev^T). It is taken from the wrench that left the gate, so the guard's own damping
/// and every limit are in it once and are never booked a second time.
/// surplus() is the sum; it may not go below -credit_j. Without that floor an hour of scraping, which puts joules in,
/// would allow a vibration to give all of them back. credit_j covers what springs hold at full force and so costs a
/// passive loop nothing. What moving bodies do to the probe is theirs: it is taken off the surplus, up to bodies_power_w,
/// and what the probe does to them is added to it. The bound below then grows by bodies_power_w times the interval.
/// Controller: with a surplus over tolerance_j (rounding, the encoder's steps), damping in proportion to the device's
/// inertia, at the rate alpha = min(surplus / (h v.M v), 0.5 / h), so that one sample takes out the surplus and the
/// damping itself stays stable. Past soft_limit_j the wanted wrench is scaled down as well, to zero at hard_limit_j.
///
/// Bound, with P and S the gate's peak and slew rate, h the sample's length and v the hand's largest speed, force and
/// torque each: surplus() <= hard_limit_j + P v (P / S + h) / 2. The second term is the sample in which the limit is
/// passed and those in which the gate takes the wrench away. Over any interval the hand receives at most that plus
/// credit_j, and plus what errors of the measured poses hide: at most the way of the wrench times the error.
/// It holds for motions slower than a quarter of the sample rate, in which damping takes energy out of every swing.
/// It is a net: a loop that needs it all the time is badly tuned. It does not replace the contact's stiffness J.
/// @source science, section 5; floor and scaling are ours
class passivity_guard {
 public:
  explicit passivity_guard(const guard_settings& settings = {}) noexcept : settings_(settings) {}

  /// Forgets all energy and the last pose.
  void reset() noexcept { *this = passivity_guard(settings_); }

  /// Books one sample: the wrench that was held since the last call (it left the gate then) and the pose reached with
  /// it. Any frame, as long as wrench and pose share it and the torque is about the pose's origin.
  /// @param from_bodies_j work that moving bodies did on the probe meanwhile
  /// @param from_weight_j work that the weight of the handle was held up with meanwhile; see handle_weight
  /// @rt safe
  void observe(const pose& T, const wrench& held, double h_s, double from_bodies_j = 0.0,
               double from_weight_j = 0.0) noexcept {
    h_s_ = h_s;
    if (!has_last_) {
      has_last_ = true;
      last_ = T;
      return;
    }
    const vec3 dx = T.position - last_.position;
    const vec3 dphi = log_rotation(T.rotation * glm::conjugate(last_.rotation));
    last_ = T;
    double given_j = glm::dot(held.force, dx) + glm::dot(held.torque, dphi);
    delivered_j_ += given_j;
    given_j -= from_weight_j;
    const double lent_j = std::min(from_bodies_j, settings_.bodies_power_w * h_s);
    surplus_j_ = std::max(-settings_.credit_j, surplus_j_ + given_j - lent_j);
    velocity_ = h_s > 0.0 ? twist{dx / h_s, dphi / h_s} : twist{};
  }

  /// The wrench that may go on to the gate.
  /// @rt safe
  [[nodiscard]] guard_action adjust(const wrench& wanted) const noexcept {
    if (!settings_.enabled || !(surplus_j_ > settings_.tolerance_j)) return {wanted, 0.0, 1.0};
    const double over = (surplus_j_ - settings_.soft_limit_j) / (settings_.hard_limit_j - settings_.soft_limit_j);
    const double scale = 1.0 - std::clamp(over, 0.0, 1.0);
    const double power_per_rate = settings_.mass_kg * glm::dot(velocity_.linear, velocity_.linear) +
                                  settings_.inertia_kg_m2 * glm::dot(velocity_.angular, velocity_.angular);
    double alpha = 0.0;
    if (power_per_rate > 0.0 && h_s_ > 0.0) alpha = std::min(surplus_j_ / (h_s_ * power_per_rate), 0.5 / h_s_);
    const wrench damping{-alpha * settings_.mass_kg * velocity_.linear,
                         -alpha * settings_.inertia_kg_m2 * velocity_.angular};
    return {scale * wanted + damping, alpha, scale};
  }

  /// Whether more than the cut-off was delivered, so that nothing but silence is left. @rt safe
  [[nodiscard]] bool exhausted() const noexcept { return settings_.enabled && surplus_j_ > settings_.cut_off_j; }

  /// Energy delivered to the hand since reset(), J; negative where the hand put more in. The plain book, without floor.
  [[nodiscard]] double delivered_j() const noexcept { return delivered_j_; }
  /// What the controller acts on: delivered energy with the floor of -credit_j, J.
  [[nodiscard]] double surplus_j() const noexcept { return surplus_j_; }
  [[nodiscard]] const guard_settings& settings() const noexcept { return settings_; }

 private:
  guard_settings settings_;
  bool has_last_ = false;
  pose last_{};
  twist velocity_{};
  double h_s_ = 0.0;
  double delivered_j_ = 0.0;
  double surplus_j_ = 0.0;
};

/// Weight of the handle that the motors hold up in the hand's place. None by default.
struct weight_settings {
  double mass_kg = 0.0;             ///< of what the hand would have to hold up
  vec3 centre_h{0.0};               ///< its centre of mass in the handle's frame, m
  vec3 gravity_d{0.0, 0.0, -9.81};  ///< in the device's base frame, m/s^2
  double ramp_s = 0.5;              ///< for which the weight is taken over once the device is armed

  [[nodiscard]] bool any() const noexcept { return mass_kg != 0.0 || std::isnan(mass_kg); }
};

/// Says what is out of range and what would do: a weight, or its moment, may take half of what the device can hold for
/// ever, the other half is for contacts. A device without torque has no moment to be held.
/// @return invalid_argument
[[nodiscard]] ASPERITY_API result<void> check(const weight_settings& w, const device_capabilities& device);

/// Holds up a handle's weight, and keeps its work apart from the contact's.
///
/// A weight that is raised is energy that the hand gets back when it comes down. The guard must not take that for the
/// loop's: what the held weight did is taken off its surplus, in the part in which it left the gate, and never more than
/// the weight has gained in height. So over any interval the hand receives at most the weight times its way up beyond
/// the guard's bound, whatever the gate let through.
/// @rt safe
class handle_weight {
 public:
  /// One that check() would refuse is not held.
  handle_weight(const weight_settings& settings, const device_capabilities& device) noexcept
      : settings_(settings), held_(settings.any() && is_within(settings, device)) {}

  /// Whether there is a weight, and it may be held.
  [[nodiscard]] bool held() const noexcept { return held_; }
  /// How much of it is held now: 0 while the device is not armed, then growing to 1.
  [[nodiscard]] double share() const noexcept { return share_; }

  /// From an accepted pose to the next one.
  /// @param held, wanted what left the gate in the tick before, and what went into it
  /// @return of the work of `held`, what is the weight's, J
  [[nodiscard]] double observe(const pose& T_dh, const wrench& held, const wrench& wanted) noexcept {
    if (!held_) return 0.0;
    const double now_j = height_j(T_dh);
    low_j_ = has_last_ ? std::min(low_j_, now_j) : now_j;
    high_j_ = has_last_ ? std::max(high_j_, now_j) : now_j;
    double raised_j = 0.0;
    if (has_last_) {
      const vec3 dx = T_dh.position - last_.position;
      const vec3 dphi = log_rotation(T_dh.rotation * glm::conjugate(last_.rotation));
      raised_j = part(held.force, wanted.force) * glm::dot(put_out_.force, dx) +
                 part(held.torque, wanted.torque) * glm::dot(put_out_.torque, dphi);
    }
    const double before_j = has_last_ ? lent_j_ : 0.0;
    lent_j_ = std::clamp(before_j + raised_j, now_j - high_j_, now_j - low_j_);
    last_ = T_dh;
    has_last_ = true;
    return lent_j_ - before_j;
  }

  /// What to put out now for the weight, in the device's base frame about the handle's origin.
  /// @param may whether the device may put out anything
  /// @param scale factor that it is put out with
  [[nodiscard]] wrench hold(const pose& T_dh, bool may, double dt_s, double scale = 1.0) noexcept {
    share_ = held_ && may ? std::min(1.0, share_ + dt_s / settings_.ramp_s) : 0.0;
    const vec3 up = -share_ * settings_.mass_kg * settings_.gravity_d;
    const wrench out{up, glm::cross(T_dh.rotation * settings_.centre_h, up)};
    put_out_ = scale * out;
    return out;
  }

  /// Forgets all poses.
  void reset() noexcept {
    has_last_ = false;
    lent_j_ = share_ = 0.0;
    put_out_ = {};
  }

 private:
  ASPERITY_API static bool is_within(const weight_settings& w, const device_capabilities& device) noexcept;

  // Of what was wanted, how much came out.
  [[nodiscard]] static double part(const vec3& held, const vec3& wanted) noexcept {
    const double whole = glm::dot(wanted, wanted);
    return whole > 0.0 ? std::clamp(glm::dot(held, wanted) / whole, 0.0, 1.0) : 0.0;
  }
  // Energy of the weight at this height, J.
  [[nodiscard]] double height_j(const pose& T_dh) const noexcept {
    return -settings_.mass_kg * glm::dot(settings_.gravity_d, T_dh * settings_.centre_h);
  }

  weight_settings settings_;
  bool held_;
  double share_ = 0.0;
  bool has_last_ = false;
  pose last_{};
  wrench put_out_{};
  double lent_j_ = 0.0;
  double low_j_ = 0.0;
  double high_j_ = 0.0;
};

}  // namespace asperity
