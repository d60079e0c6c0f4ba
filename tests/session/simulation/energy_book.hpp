// The energy that reached the hand, booked a second time.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/control/passivity_guard.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity::simulation {

/// What one tick means for the book.
struct booked_tick {
  bool accepted = false;   ///< a pose came that could be used
  pose T_dh{};             ///< that pose
  wrench commanded{};      ///< what the device is told to put out from now on
  bool expired = false;    ///< the last command had expired before this tick: the device put out nothing
  bool uncertain = false;  ///< in the time since the last tick the device did something else than it was told
  double slew_s = 0.0;     ///< time that the gate may use for a change in this tick
  double step_s = 0.0;     ///< time that the loop says has passed since the last tick
};

/// Sums up F . dx + T . log(dR) from what the device was told and what it measured, and states what the sum may be.
///
/// With S the sum that may not go below -credit, two bounds hold:
///
///     S <= cut-off    + X + U     and     S <= hard limit + X + D + U.
///
/// X: the sample in which S passes the limit is over before the guard knows, and in the samples after it the wrench is
/// on its way, at the slew rate. X is the work of these samples, counted where positive. Past the cut-off the target is
/// zero, reached in the time peak / slew. Past the hard limit it is damping: F = -alpha m v with alpha <= 1 / 2h, at
/// most F_max so far. Outside the ball of radius 2 F_max a step of length s towards any point of the ball of radius
/// F_max brings the wrench closer by at least s / 3: after 3 peak / slew it is within 2 F_max.
/// D: from then on only damping is left, within 2 F_max. It gives energy where the velocity turns.
/// U: where a pose is missing, or the device did something else than it was told, the work is known only up to the
/// wrenches in the gap times the way.
class energy_book {
 public:
  /// @param slew_time_s peak / slew of the gate
  energy_book(const guard_settings& guard, double slew_time_s) noexcept
      : guard_(guard), hard_(guard.hard_limit_j, 3.0 * slew_time_s), cut_off_(guard.cut_off_j, slew_time_s) {}

  /// Begins anew: a person cleared the loop's fault.
  void reset() noexcept { *this = energy_book(guard_, cut_off_.slew_time_s()); }

  void book(const booked_tick& t) noexcept {
    if (t.expired) commanded_ = {};
    gap_.widen(commanded_);
    gap_.widen(t.commanded);
    gap_.uncertain = gap_.uncertain || t.uncertain;
    step_s_ += t.step_s;
    if (t.accepted) {
      if (has_pose_) add(t.T_dh);
      has_pose_ = true;
      last_ = t.T_dh;
      gap_ = {.uncertain = t.uncertain};
      step_s_ = 0.0;
    } else {
      gap_.uncertain = true;
    }
    commanded_ = t.commanded;
    hard_.slew(surplus_j_, t.slew_s);
    cut_off_.slew(surplus_j_, t.slew_s);
  }

  /// Energy delivered to the hand, J, and the same with the floor of -credit.
  [[nodiscard]] double delivered_j() const noexcept { return delivered_j_; }
  [[nodiscard]] double surplus_j() const noexcept { return surplus_j_; }
  /// What is not known of them, J.
  [[nodiscard]] double unknown_j() const noexcept { return unknown_j_; }
  [[nodiscard]] double hard_bound_j() const noexcept {
    return guard_.hard_limit_j + hard_.moving_j() + hard_.settled_j() + unknown_j_;
  }
  [[nodiscard]] double cut_off_bound_j() const noexcept { return guard_.cut_off_j + cut_off_.moving_j() + unknown_j_; }
  /// Whether the surplus has been past the hard limit for so long that only damping may be left ...
  [[nodiscard]] bool only_damping_left() const noexcept { return hard_.settled(); }
  /// ... and the most that damping can be: 2 F_max and 2 T_max, for a mass and an inertia of one.
  [[nodiscard]] double most_damping_per_kg() const noexcept { return 2.0 * most_damping_.linear; }
  [[nodiscard]] double most_damping_per_kg_m2() const noexcept { return 2.0 * most_damping_.angular; }

 private:
  // Work since the surplus passed a limit: while the wrench is on its way, and after.
  class excess {
   public:
    excess(double limit_j, double slew_time_s) noexcept : limit_j_(limit_j), slew_time_s_(slew_time_s) {}

    // One sample's work, before it is added to the surplus.
    void book(double surplus_j, double given_j) noexcept {
      if (surplus_j <= limit_j_) since_s_ = moving_j_ = settled_j_ = 0.0;
      (settled() ? settled_j_ : moving_j_) += std::max(0.0, given_j);
    }
    void slew(double surplus_j, double slew_s) noexcept { since_s_ = surplus_j > limit_j_ ? since_s_ + slew_s : 0.0; }

    [[nodiscard]] bool settled() const noexcept { return since_s_ > slew_time_s_; }
    [[nodiscard]] double moving_j() const noexcept { return moving_j_; }
    [[nodiscard]] double settled_j() const noexcept { return settled_j_; }
    [[nodiscard]] double slew_time_s() const noexcept { return slew_time_s_; }

   private:
    double limit_j_;
    double slew_time_s_;
    double since_s_ = 0.0;
    double moving_j_ = 0.0;
    double settled_j_ = 0.0;
  };

  struct accelerations {
    double linear = 0.0;
    double angular = 0.0;
  };

  // The time between two poses that could be used: one period, or more.
  struct gap {
    bool uncertain = false;
    double force_n = 0.0;
    double torque_n_m = 0.0;

    void widen(const wrench& w) noexcept {
      force_n = std::max(force_n, glm::length(w.force));
      torque_n_m = std::max(torque_n_m, glm::length(w.torque));
    }
  };

  void add(const pose& T_dh) noexcept {
    const vec3 dx = T_dh.position - last_.position;
    const vec3 dphi = log_rotation(T_dh.rotation * glm::conjugate(last_.rotation));
    const double given_j = glm::dot(commanded_.force, dx) + glm::dot(commanded_.torque, dphi);
    if (gap_.uncertain) unknown_j_ += 2.0 * (gap_.force_n * glm::length(dx) + gap_.torque_n_m * glm::length(dphi));
    hard_.book(surplus_j_, given_j);
    cut_off_.book(surplus_j_, given_j);
    delivered_j_ += given_j;
    surplus_j_ = std::max(-guard_.credit_j, surplus_j_ + given_j);
    if (surplus_j_ <= guard_.hard_limit_j) most_damping_ = {};
    if (step_s_ > 0.0) {
      most_damping_.linear = std::max(most_damping_.linear, 0.5 * glm::length(dx) / (step_s_ * step_s_));
      most_damping_.angular = std::max(most_damping_.angular, 0.5 * glm::length(dphi) / (step_s_ * step_s_));
    }
  }

  guard_settings guard_;
  excess hard_;
  excess cut_off_;
  accelerations most_damping_{};
  double step_s_ = 0.0;
  bool has_pose_ = false;
  pose last_{};
  wrench commanded_{};
  gap gap_{};
  double delivered_j_ = 0.0;
  double surplus_j_ = 0.0;
  double unknown_j_ = 0.0;
};

}  // namespace asperity::simulation
