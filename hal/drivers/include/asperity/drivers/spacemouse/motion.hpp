// From the displacement of a cap that springs back to a pose that a session can use.
#pragma once

#include <array>
#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// Meaning of a displacement of the cap.
enum class spacemouse_control : std::uint8_t {
  rate,      ///< a speed: the pose moves on while the cap is pushed and stays where it is when it is let go
  position,  ///< a place: the pose follows the cap, and returns with it
};

/// How the cap moves the pose.
///
/// Device axes are x right, y towards the person, z down, for shifts and for turns; turns are right handed about them.
/// The base frame d is x right, y away from the person, z up: both are right handed, half a turn about x apart, so one
/// rotation maps shifts and turns alike. This follows published recordings and has not been seen on a device.
struct spacemouse_motion_settings {
  spacemouse_control control = spacemouse_control::rate;
  double max_speed_m_per_s = 0.1;   ///< rate: at full displacement; position: the fastest that the pose follows
  double max_turn_rad_per_s = 1.0;  ///< likewise
  double reach_m = 0.05;            ///< position: at full displacement
  double reach_rad = 0.5;           ///< position: at full displacement
  double dead_zone = 0.04;          ///< share of full displacement that counts as none, 0 to below 1; what is
                                    ///< beyond it begins at zero, without a step
  std::array<double, 6> gain{1, 1, 1, 1, 1, 1};  ///< per device axis, -1 to 1: below 0 turned round, 0 off
  quat R_dn{0.0, 1.0, 0.0, 0.0};                 ///< device axes n in the base frame d; GLM's order w x y z
  vec3 workspace_low_d{-0.1, -0.1, -0.1};        ///< the pose's origin stays in this box
  vec3 workspace_high_d{0.1, 0.1, 0.1};
  pose T_dh_start{};  ///< where the handle is when the device is opened; position: where it rests
  std::int64_t longest_step_ns = 20'000'000;  ///< a later tick moves the pose by this much time only
};

/// Integrates or follows. For any input the pose is finite, of unit length and in its box, and moves no faster
/// than the configuration says.
/// @rt safe after construction
class ASPERITY_API spacemouse_motion {
 public:
  explicit spacemouse_motion(const spacemouse_motion_settings& settings = {}) noexcept;

  /// Back to the start, at rest.
  void reset() noexcept;

  /// Where the cap is, as shares of full displacement in device axes. More than one counts as one, NaN as none.
  void displace(const std::array<double, 6>& share) noexcept;

  /// Whether the cap is at rest.
  [[nodiscard]] bool at_rest() const noexcept;

  /// The time that has gone by. Less than none counts as none.
  void advance(std::int64_t step_ns) noexcept;

  [[nodiscard]] const pose& T_dh() const noexcept { return T_dh_; }
  /// Over the last step.
  [[nodiscard]] const twist& velocity_d() const noexcept { return velocity_d_; }
  [[nodiscard]] const spacemouse_motion_settings& settings() const noexcept { return settings_; }

 private:
  // A number that makes no sense becomes the one that moves nothing.
  [[nodiscard]] static spacemouse_motion_settings sane(spacemouse_motion_settings c) noexcept;

  [[nodiscard]] double beyond_dead_zone(double share) const noexcept;
  [[nodiscard]] static vec3 no_longer_than(const vec3& v, double limit) noexcept;

  spacemouse_motion_settings settings_;
  pose T_dh_{};
  twist velocity_d_{};
  vec6 wanted_n_{};
};

}  // namespace asperity
