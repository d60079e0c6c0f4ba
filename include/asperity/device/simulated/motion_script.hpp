// What the simulated hand means to do.
#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

enum class motion_kind : std::uint8_t {
  press,  ///< approach along a direction, then hold
  scrub,  ///< approach, then to and fro sideways
  twist,  ///< approach, then turn to and fro about the direction
  tap,    ///< approach, then lift off and come down again and again, in a seeded, slightly uneven rhythm
  free,   ///< wander in a box, seeded, without a direction
};

/// One motion of the hand, in the device's base frame. Times count from the script's beginning.
struct motion_settings {
  motion_kind kind = motion_kind::press;
  pose T_dh{};                       ///< pose at the beginning
  vec3 direction_d{0.0, 0.0, -1.0};  ///< of the approach; unit
  vec3 sideways_d{1.0, 0.0, 0.0};    ///< of scrub; unit
  double depth_m = 0.01;             ///< length of the approach
  double approach_s = 0.5;           ///< time of the approach, smooth at both ends
  double amplitude_m = 0.01;         ///< of scrub, height of tap's lift, and half the box's size of free
  double amplitude_rad = 0.2;        ///< of twist and free
  double frequency_hz = 1.0;         ///< of scrub and twist, mean of tap, and typical of free
};

/// Where the hand wants the handle, and how fast it means to move.
struct hand_target {
  pose T_dh{};
  twist velocity_d{};
};

/// Target of the hand as a function of time: smooth, without state, the same for the same seed.
class ASPERITY_API motion_script {
 public:
  explicit motion_script(const motion_settings& settings = {}, std::uint64_t seed = 0);

  /// @rt safe
  [[nodiscard]] hand_target at(double t_s) const noexcept;

  [[nodiscard]] const motion_settings& settings() const noexcept { return settings_; }

 private:
  struct wave {
    double rate_rad_per_s = 0.0;
    double phase_rad = 0.0;
  };
  static constexpr double two_pi = 6.283185307179586;
  static constexpr double ramp_s = 0.25;  // the motion after the approach grows to its amplitude over this time

  [[nodiscard]] static double unit(std::mt19937_64& bits) noexcept;
  [[nodiscard]] hand_target approach_and_move(double t_s) const noexcept;

  // Up from the pressed pose and back to it. A slow seeded wave goes before or behind the mean rhythm, by less than a
  // beat, so that blows do not keep step with any period of the loops.
  void add_taps(double since, double grown, hand_target& out) const noexcept;

  [[nodiscard]] hand_target wander(double t_s) const noexcept;

  // Angular velocity of exp(phi(t)) from phi and its rate.
  [[nodiscard]] static vec3 angular_velocity(const vec3& phi, const vec3& rate) noexcept;

  motion_settings settings_;
  std::array<wave, 6> waves_{};
};

}  // namespace asperity
