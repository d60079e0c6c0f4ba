// One body's samples in another body's field, at one pose.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "least_motion/exit_scene.hpp"
#include "least_motion/motion.hpp"

namespace asperity::exits {

/// One sample in the field of the body across, and how deep it was where it was found.
struct mark {
  vec3 place_y{0.0};         ///< in the frame of the field's body, at the pose as given
  double relief_m = 0.0;     ///< read at the pose as given
  double depth_m = 0.0;      ///< S' + relief at the motion of the probe where the mark was found
  std::uint32_t sample = 0;  ///< of its body
  std::uint32_t meeting = 0;
};

/// Samples of body X in the field of body Y; one of the two is the probe.
struct meeting {
  const exit_body *of_x = nullptr, *in_y = nullptr;
  pose T_wx;
  mat3 turn_yx{1.0};  ///< with shift_y: from X's frame to Y's, at the pose as given
  vec3 shift_y{0.0};
  mat3 motion_y{1.0};            ///< from a motion of the probe, world axes, to that of X's points in Y's frame
  vec3 pivot_y{0.0};             ///< in Y's frame, at the pose as given
  std::uint32_t body = 0;        ///< index in scene::fixed of the body that is not the probe
  bool of_probe = true;          ///< X is the probe
  std::size_t first_sample = 0;  ///< in the list that posed_samples keeps per sample
  std::size_t first_branch = 0;  ///< in its list per branch
};

/// What a solve may spend, and what it has spent: readings of a field or of a table of its bounds.
struct reading_count {
  std::size_t spent = 0, most = 0;
  bool cut = false;  ///< something was left out because no readings were left

  [[nodiscard]] bool left() noexcept {
    if (spent < most) return true;
    cut = true;
    return false;
  }
};

/// A motion of the probe as Y's frame sees it. @rt safe
struct moved_by {
  vec3 shift_y, turn_y, pivot_y;
  double longer;  ///< lengths grow by this at most

  moved_by(const meeting& m, const motion& x) noexcept
      : shift_y(m.motion_y * x.shift_w),
        turn_y(m.motion_y * x.turn_w),
        pivot_y(m.pivot_y),
        longer(std::sqrt(1.0 + glm::dot(x.turn_w, x.turn_w))) {}
  [[nodiscard]] vec3 operator()(const vec3& place_y) const noexcept {
    return place_y + shift_y + glm::cross(turn_y, place_y - pivot_y);
  }
};
/// Where a motion takes a place. @rt safe
[[nodiscard]] inline vec3 moved(const meeting& m, const vec3& place_y, const motion& x) noexcept {
  return moved_by(m, x)(place_y);
}

}  // namespace asperity::exits
