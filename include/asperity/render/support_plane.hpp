// The surface near the probe as planes: what a renderer can tell of contacts and of gaps alike.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>

#include "asperity/core/spatial.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// One plane that a small part of a fixed body's surface puts in the way of the probe, as seen from one probe pose q0.
/// The depth at another pose q near it is depth_m + gradient . (q - q0), q = (translation of c_A; rotation vector).
/// All planes together are the depth of the pair: the largest of them. World axes.
struct support_plane {
  double depth_m = 0.0;          ///< directional penetration depth at q0; negative: a gap
  vec6 gradient{};               ///< of the depth by the probe's motion about c_A, m/m and m/rad
  vec3 n_ab_w{0.0};              ///< direction of the contact: unit, from the probe A to the body B
  vec3 r_w{0.0};                 ///< from c_A to the point that the plane stands for, m
  double spread_m = 0.0;         ///< radius across n_ab_w of the surface that the plane stands for, m
  std::uint32_t body = 0;        ///< index of B in scene::fixed
  std::uint32_t sample = 0;      ///< planes of one body with the same number stand for the same point; 0: not known
  double back_m = 0.0;           ///< the surface is felt this much further in than it is; depth_m is less by it
  double closing_m_per_s = 0.0;  ///< how fast the depth grows by the body's own motion; 0 for a body at rest
  std::uint8_t of_probe = 0;     ///< number of the probe's material where the point is; see material_map
  std::uint8_t of_body = 0;      ///< and of the body's
};

/// @rt safe
[[nodiscard]] inline bool is_finite(const support_plane& p) noexcept {
  return std::isfinite(p.depth_m) && is_finite(p.gradient) && is_finite(p.n_ab_w) && is_finite(p.r_w) &&
         std::isfinite(p.spread_m) && std::isfinite(p.back_m) && std::isfinite(p.closing_m_per_s);
}

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

/// A stage of a renderer that knows the support planes of its last tick, gaps included. Gaps should be reported up to
/// 3 v T, v the fastest approach and T the contact loop's period: a contact is handed over a period after its pose and
/// used for another, and the probe waits for what is not reported by then. A gap behind others that every motion meets
/// before it need not be reported.
/// The order of the planes must not depend on addresses or time. The span lives until the next tick.
template <class P>
concept reports_support_planes = requires(const P& stage) {
  { stage.support_planes() }
  noexcept->std::same_as<std::span<const support_plane>>;
};

/// A stage of a renderer that knows how far the probe may move from the pose of its last tick.
template <class P>
concept reports_known_motion = requires(const P& stage) {
  { stage.known() }
  noexcept->std::same_as<known_motion>;
};

/// A stage of a renderer that knows what the planes of its last tick do not answer.
template <class P>
concept reports_tick_flags = requires(const P& stage) {
  { stage.flags() }
  noexcept->std::same_as<tick_flag>;
};

}  // namespace asperity
