// The energy that reaches the hand, booked from the simulated device's true plant, and the bound stated for it.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/control/passivity_guard.hpp"
#include "asperity/control/session_record.hpp"
#include "asperity/device/output_gate.hpp"

namespace asperity::test_support {

/// Follows one session tick by tick. Nothing here comes from the guard's own book.
///
/// surplus: the energy delivered to the hand beyond what the hand lent, of which at most the guard's credit counts.
/// Stated bound of the surplus, for a guard with hard limit L behind a gate with peak P and slew rate S (force and
/// torque each), samples of length h, and a hand no faster than v:
///
///     L + P v h (n + 1) / 2 + measurement,   n = P / (S h)
///
/// Second term: the sample in which the sum passes L begins with P at most, and the gate takes P away in n more
/// samples: P v h (1 + (n-1)/n + ... + 1/n).
/// Third term: the guard knows measured poses only, e_k away from the true ones. With F_k held after sample k, the true
/// work minus the observed work is, summed by parts, F_k . e_k - sum (F_i - F_(i-1)) . e_i, less the same at the
/// interval's beginning: at most the wrench's way times the error, and two ends.
/// Over any interval the hand receives at most the credit more than that.
class energy_bound {
 public:
  energy_bound(const guard_settings& guard, const gate_limits& gate, double period_s) noexcept
      : guard_(guard), gate_(gate), period_s_(period_s) {}

  /// After each device tick: the true energy delivered since the beginning, the true pose and velocity, and the record
  /// of the tick for what was measured and what was sent.
  void observe(double delivered_j, const pose& true_T_dh, const twist& true_velocity_d,
               const session_record& r) noexcept {
    least_j_ = std::min(least_j_, delivered_j);
    largest_gain_j_ = std::max(largest_gain_j_, delivered_j - least_j_);
    surplus_j_ = std::max(-guard_.credit_j, surplus_j_ + (delivered_j - before_j_));
    largest_surplus_j_ = std::max(largest_surplus_j_, surplus_j_);
    before_j_ = delivered_j;

    speed_m_per_s_ = std::max(speed_m_per_s_, glm::length(true_velocity_d.linear));
    turn_rad_per_s_ = std::max(turn_rad_per_s_, glm::length(true_velocity_d.angular));

    const vec6 error{true_T_dh.position - r.T_dh.position,
                     log_rotation(true_T_dh.rotation * glm::conjugate(r.T_dh.rotation))};
    const vec6 now = to_vec6(r.on_hand_d);
    const vec6 change = now - sent_;
    sent_ = now;
    measurement_j_ += product(change, error);
    largest_end_j_ = std::max(largest_end_j_, product(now, error));
    observed_gap_j_ -= dot(change, error);
    last_end_j_ = dot(now, error);
  }

  /// Most energy that the hand received between two ticks, J.
  [[nodiscard]] double largest_gain_j() const noexcept { return largest_gain_j_; }
  [[nodiscard]] double gain_bound_j() const noexcept { return guard_.credit_j + surplus_bound_j(); }

  /// Largest surplus, J; zero where the hand never received what it had not lent.
  [[nodiscard]] double largest_surplus_j() const noexcept { return largest_surplus_j_; }
  [[nodiscard]] double surplus_bound_j() const noexcept {
    return guard_.hard_limit_j + overshoot_j(gate_.peak_force_n, gate_.force_slew_n_per_s, speed_m_per_s_) +
           overshoot_j(gate_.peak_torque_n_m, gate_.torque_slew_n_m_per_s, turn_rad_per_s_) + measurement_j_ +
           2.0 * largest_end_j_;
  }

  /// True energy minus the energy that a perfect book of measured poses would show, by the measurement's errors, J.
  [[nodiscard]] double observed_gap_j() const noexcept { return observed_gap_j_ + last_end_j_; }

 private:
  [[nodiscard]] static double product(const vec6& w, const vec6& way) noexcept {
    return glm::length(w.linear) * glm::length(way.linear) + glm::length(w.angular) * glm::length(way.angular);
  }
  [[nodiscard]] double overshoot_j(double peak, double slew_per_s, double speed) const noexcept {
    const double samples = std::ceil(peak / (slew_per_s * period_s_));
    return 0.5 * peak * speed * period_s_ * (samples + 1.0);
  }

  guard_settings guard_;
  gate_limits gate_;
  double period_s_;
  double least_j_ = 0.0;
  double largest_gain_j_ = 0.0;
  double surplus_j_ = 0.0;
  double largest_surplus_j_ = 0.0;
  double before_j_ = 0.0;
  double speed_m_per_s_ = 0.0;
  double turn_rad_per_s_ = 0.0;
  double measurement_j_ = 0.0;
  double largest_end_j_ = 0.0;
  double observed_gap_j_ = 0.0;
  double last_end_j_ = 0.0;
  vec6 sent_{};
};

}  // namespace asperity::test_support
