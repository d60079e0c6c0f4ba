// The safety net at the device's port: what the hand gets back may not exceed what it put in.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

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
  /// @rt safe
  void observe(const pose& T, const wrench& held, double h_s, double from_bodies_j = 0.0) noexcept {
    h_s_ = h_s;
    if (!has_last_) {
      has_last_ = true;
      last_ = T;
      return;
    }
    const vec3 dx = T.position - last_.position;
    const vec3 dphi = log_rotation(T.rotation * glm::conjugate(last_.rotation));
    last_ = T;
    const double given_j = glm::dot(held.force, dx) + glm::dot(held.torque, dphi);
    delivered_j_ += given_j;
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

}  // namespace asperity
