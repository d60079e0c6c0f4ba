// A simulated hand that somebody leads while the session runs, such as a person with a mouse.
#pragma once

#include <algorithm>
#include <cmath>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/triple_buffer.hpp"
#include "asperity/device/simulated/motion_script.hpp"

namespace asperity {

/// Where a simulated hand is wanted. One thread tells, the device's reads; neither waits.
class hand_lead {
 public:
  /// From the thread that tells. @pre is_valid(T_dh)   @rt safe
  void lead_to(const pose& T_dh) noexcept {
    wanted_.back() = {T_dh, true};
    wanted_.publish();
  }
  /// The newest that was told; null before the first. From the device's thread. @rt safe
  [[nodiscard]] const pose* newest() noexcept {
    static_cast<void>(wanted_.refresh());
    return wanted_.front().told ? &wanted_.front().T_dh : nullptr;
  }

 private:
  struct wanted {
    pose T_dh{};
    bool told = false;
  };
  triple_buffer<wanted> wanted_;
};

/// The way of a hand that follows poses which come by jumps, thirty times a second: smooth, without overshoot, and no
/// faster than an arm. @rt safe
class led_motion {
 public:
  static constexpr double follows_s = 0.02;       ///< time constant
  static constexpr double fastest_m_per_s = 0.5;  ///< of a hand that feels
  static constexpr double fastest_rad_per_s = 5.0;

  explicit led_motion(const pose& begin = {}) noexcept : now_{begin, {}} {}

  /// h_s seconds later. @pre is_valid(goal), h_s <= follows_s
  [[nodiscard]] const hand_target& follow(const pose& goal, double h_s) noexcept {
    constexpr double rate = 1.0 / follows_s;
    twist& v = now_.velocity_d;
    const vec3 way = goal.position - now_.T_dh.position;
    const vec3 turn = log_rotation(goal.rotation * glm::conjugate(now_.T_dh.rotation));
    // The damper is taken at the end of the step, so that any step is stable.
    const double damped = 1.0 / (1.0 + 2.0 * rate * h_s);
    v.linear = limited(damped * (v.linear + h_s * rate * rate * way), fastest_m_per_s);
    v.angular = limited(damped * (v.angular + h_s * rate * rate * turn), fastest_rad_per_s);
    now_.T_dh.position += h_s * v.linear;
    now_.T_dh.rotation = glm::normalize(exp_rotation(h_s * v.angular) * now_.T_dh.rotation);
    return now_;
  }
  [[nodiscard]] const hand_target& now() const noexcept { return now_; }

 private:
  [[nodiscard]] static vec3 limited(const vec3& v, double most) noexcept {
    const double size = std::sqrt(glm::dot(v, v));
    return size > most ? (most / size) * v : v;
  }

  hand_target now_;
};

}  // namespace asperity
