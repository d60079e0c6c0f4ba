// How far the probe may move before it can meet surface that a tick does not know.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>

#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// How far the probe may move from the pose of a tick: while share() is at most 1, it meets no surface but that of the
/// tick's planes. Infinite where a renderer does not say.
struct known_motion {
  double way_m = std::numeric_limits<double>::infinity();     ///< of c_A, where the probe does not turn; above 0
  double turn_rad = std::numeric_limits<double>::infinity();  ///< about c_A, where it does not move; above 0

  [[nodiscard]] bool is_limited() const noexcept { return std::isfinite(way_m) && std::isfinite(turn_rad); }
  /// How much of it a motion takes, about c_A: 0 none, 1 all. @rt safe
  [[nodiscard]] double share(const vec6& moved) const noexcept {
    return std::sqrt(glm::dot(moved.linear, moved.linear)) / way_m +
           std::sqrt(glm::dot(moved.angular, moved.angular)) / turn_rad;
  }
};

/// A stage of a renderer that knows how far the probe may move from the pose of its last tick.
template <class P>
concept reports_known_motion = requires(const P& stage) {
  { stage.known() }
  noexcept->std::same_as<known_motion>;
};

}  // namespace asperity
