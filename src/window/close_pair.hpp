// One pair of convex pieces that are closer than the tolerance: its direction, separation and weight.
#pragma once

#include <algorithm>
#include <cstdint>

#include "window/convex_shape.hpp"
#include "window/gjk.hpp"
#include "window/sat.hpp"

namespace asperity {

/// What the narrow phase decides about a pair of pieces.
enum class pair_kind : std::uint8_t {
  apart,    ///< further apart than the tolerance, and not through the inside of a body either
  active,   ///< close, with a direction that leaves the real surface of both pieces
  passive,  ///< close, but in no direction of the real surface: it widens a contact's region only
};

/// A pair in the frame of A. Fields after `weight` are set for active pairs only.
struct close_pair {
  std::uint32_t a = 0, b = 0;  ///< pieces
  bounds region;               ///< where the two pieces' boxes overlap, or what lies between them, and half a tolerance
  pair_kind kind = pair_kind::apart;
  double presence = 0.0;  ///< how much of `region` counts: 0 at the tolerance, 1 a little inside it
  double weight = 0.0;    ///< 0 at the tolerance, 1 at touch, growing with depth; continuous in the pose
  vec3 n_ab{0.0};         ///< unit
  double separation_m = 0.0;
  vec3 p_a{0.0}, p_b{0.0};  ///< witness points
};

/// Limits of the narrow phase, metres.
struct narrow_phase_limits {
  double tolerance_m = 0.0;  ///< pairs further apart are not close
  double max_depth_m = 0.0;  ///< a depth beyond it belongs to the other side of the body
};

/// Weight of a pair by its separation: 0 with zero slope at the tolerance.
/// @rt safe
[[nodiscard]] inline double separation_weight(double separation_m, double tolerance_m) noexcept {
  const double x = std::max(0.0, 1.0 - separation_m / tolerance_m);
  return x * x;
}

/// Distances of the pairs that a pass over the candidates looks for, metres: beyond `inner_m` up to `outer_m`.
/// The near pass has a negative inner limit and ends at the tolerance. The deep pass begins there and takes only pairs
/// whose surfaces have passed through each other.
struct distance_shell {
  double inner_m = -1.0;
  double outer_m = 0.0;
  [[nodiscard]] bool deep() const noexcept { return inner_m >= 0.0; }
};

/// Cost of a pair, and whether its hulls overlap.
struct narrow_phase_cost {
  std::uint32_t gjk_iterations = 0;  ///< most of one call
  bool overlapping = false;          ///< the hulls share a point
};

/// False where no two faces of the pieces can have passed through each other: they do not face each other, or one
/// piece's bounding sphere lies wholly outside the other's face. A filter for the deep pass, far cheaper than GJK.
/// @rt safe
[[nodiscard]] inline bool may_have_passed(const convex_shape& A, const convex_shape& B,
                                          const placement& T_ab) noexcept {
  const vec3 centre_b = T_ab * B.centre;
  const vec3 centre_a = T_ab.to_local(A.centre - T_ab.position);
  for (const shape_face& f : A.faces) {
    if (glm::dot(f.normal, centre_b) - B.radius > f.offset) continue;
    const vec3 f_in_b = T_ab.to_local(f.normal);
    for (const shape_face& g : B.faces) {
      if (glm::dot(f_in_b, g.normal) < 0.0 && glm::dot(g.normal, centre_a) - A.radius <= g.offset) return true;
    }
  }
  return false;
}

namespace detail {

/// Sine of the angle outside a normal cone at which a direction has lost all its weight: pieces are convex within a
/// tolerance, so neighbouring real directions may miss each other by a little.
inline constexpr double cone_slack = 0.1;

/// The least depth among directions that leave the real surface of both pieces and along which the pieces meet: moved
/// a tolerance apart along the direction, GJK must find them a tolerance apart. Any other direction would push sideways
/// out of a cut between two pieces.
inline bool find_penetration(const convex_shape& A, const convex_shape& B, const placement& T_ab,
                             const narrow_phase_limits& limits, close_pair& pair, narrow_phase_cost& cost) noexcept {
  const double tolerance = limits.tolerance_m;
  const vec3 apart = T_ab * B.centre - A.centre;
  const double reach = A.radius + B.radius + tolerance;
  separating_directions directions;
  find_separating_directions(A, B, T_ab, directions);
  for (const separating_direction& d : directions) {
    // Far deeper than what parts the pieces: the direction belongs to another place of contact, or to none.
    const double deepest = 2.0 * directions[0].separation_m - tolerance;
    if (d.separation_m < -limits.max_depth_m || d.separation_m < deepest) return false;
    if (d.separation_m >= tolerance) continue;
    // Spheres that miss each other across the direction: far cheaper to test than the two conditions below.
    const vec3 across = apart - glm::dot(apart, d.n_ab) * d.n_ab;
    if (glm::dot(across, across) > reach * reach) continue;
    const double share =
        normal_cone_share(A, d.n_ab, cone_slack) * normal_cone_share(B, T_ab.to_local(-d.n_ab), cone_slack);
    if (share <= 0.0) continue;
    const vec3 shift = (tolerance - d.separation_m) * d.n_ab;
    placement moved = T_ab;
    moved.position += shift;
    gjk_cache cold;
    const gjk_result meet = gjk_distance(A, B, moved, 1.05 * tolerance, cold);
    cost.gjk_iterations = std::max(cost.gjk_iterations, meet.iterations);
    if (meet.outcome != gjk_outcome::separated) continue;
    pair.weight =
        share * smoothstep((d.separation_m - deepest) / tolerance) * separation_weight(d.separation_m, tolerance);
    if (pair.weight <= 0.0) return false;
    pair.kind = pair_kind::active;
    pair.n_ab = d.n_ab;
    pair.separation_m = d.separation_m;
    pair.p_a = meet.p_a;
    pair.p_b = meet.p_b - shift;
    return true;
  }
  return false;
}

}  // namespace detail

/// Kind, direction, separation and witness points of a pair whose a and b are set.
/// A gap takes GJK's direction. An overlap, or a gap across which the pieces do not face each other, takes the least
/// depth of the real surface.
/// @rt safe
inline void evaluate_pair(const convex_shape& A, const convex_shape& B, const placement& T_ab,
                          const narrow_phase_limits& limits, const distance_shell& shell, gjk_cache& cache,
                          close_pair& pair, narrow_phase_cost& cost) noexcept {
  // Closer than this share of the size, the direction of GJK loses digits; faces and edges give it exactly.
  constexpr double direction_limit = 1e-7;

  cost = {};
  pair.kind = pair_kind::apart;
  pair.weight = 0.0;
  const gjk_result g = gjk_distance(A, B, T_ab, shell.outer_m, cache);
  cost.gjk_iterations = g.iterations;
  if (g.outcome == gjk_outcome::beyond || g.distance <= shell.inner_m) return;

  cost.overlapping = g.outcome == gjk_outcome::overlapping || g.distance < direction_limit * (A.radius + B.radius);
  const bool behind = !cost.overlapping && A.looks_away(g.n_ab) && B.looks_away(T_ab.to_local(-g.n_ab));
  // A region that appeared in full at the tolerance would make the window jump; it grows over an eighth of it.
  pair.presence = cost.overlapping || behind ? 1.0 : std::min(1.0, 8.0 * (1.0 - g.distance / limits.tolerance_m));
  if (cost.overlapping || behind) {
    if (!detail::find_penetration(A, B, T_ab, limits, pair, cost)) pair.kind = pair_kind::passive;
    return;
  }
  if (shell.deep()) return;
  const double share = normal_cone_share(A, g.n_ab, detail::cone_slack) *
                       normal_cone_share(B, T_ab.to_local(-g.n_ab), detail::cone_slack);
  pair.weight = share * separation_weight(g.distance, limits.tolerance_m);
  pair.kind = pair.weight > 0.0 ? pair_kind::active : pair_kind::passive;
  pair.n_ab = g.n_ab;
  pair.separation_m = g.distance;
  pair.p_a = g.p_a;
  pair.p_b = g.p_b;
}

}  // namespace asperity
