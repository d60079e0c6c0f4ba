// One pair of convex pieces that are closer than the tolerance: its direction, separation and weight.
#pragma once

#include <algorithm>
#include <cstdint>

#include "asperity/collision/convex_shape.hpp"
#include "asperity/collision/gjk.hpp"
#include "asperity/collision/sat.hpp"

namespace asperity {

/// What the narrow phase decides about a pair of pieces.
enum class pair_kind : std::uint8_t {
  apart,     ///< further apart than the tolerance
  active,    ///< close, with a direction that leaves the real surface of both pieces
  passive,   ///< close, but its direction is a ghost: it widens a contact's region and has no say in its direction
  rejected,  ///< deeper than the limit, or only near through the inside of a body
};

/// A pair in the frame of A. Fields after `weight` are set for active pairs only.
struct close_pair {
  std::uint32_t a = 0, b = 0;  ///< pieces
  bounds region;               ///< where the two pieces' boxes, grown by half the tolerance, overlap
  pair_kind kind = pair_kind::apart;
  double weight = 0.0;  ///< 0 at the tolerance, 1 at touch, growing with depth; continuous in the pose
  vec3 n_ab{0.0};       ///< unit
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

/// Kind, direction, separation and witness points of a pair whose a and b are set.
/// A gap takes GJK's direction. An overlap, or a gap seen from inside a body, takes the least depth among directions
/// that leave the real surface of both pieces and along which the pieces meet: moved apart along the direction, GJK
/// must find them as far apart as they were moved. Everything else would push sideways out of a cut.
/// @param[out] iterations largest GJK iteration count met
/// @rt safe
inline void evaluate_pair(const convex_shape& A, const convex_shape& B, const placement& T_ab,
                          const narrow_phase_limits& limits, gjk_cache& cache, close_pair& pair,
                          std::uint32_t& iterations, bool& overlapping) noexcept {
  // Sine of the angle outside a normal cone at which a direction has lost all its weight: pieces are convex within
  // a tolerance, so neighbouring real directions may miss each other by a little.
  constexpr double cone_slack = 0.1;
  // Closer than this share of the size, the direction of GJK loses digits; faces and edges give it exactly.
  constexpr double direction_limit = 1e-7;

  const double tolerance = limits.tolerance_m;
  const auto share = [&](const vec3& n) {
    return normal_cone_share(A, n, cone_slack) * normal_cone_share(B, T_ab.to_local(-n), cone_slack);
  };

  const gjk_result g = gjk_distance(A, B, T_ab, tolerance, cache);
  iterations = std::max(iterations, g.iterations);
  overlapping = false;
  pair.kind = pair_kind::apart;
  if (g.outcome == gjk_outcome::beyond) return;

  overlapping = g.outcome == gjk_outcome::overlapping || g.distance < direction_limit * (A.radius + B.radius);
  if (!overlapping && A.faces_along(g.n_ab) && B.faces_along(T_ab.to_local(-g.n_ab))) {
    const double direct = share(g.n_ab);
    pair.weight = direct * separation_weight(g.distance, tolerance);
    pair.kind = pair.weight > 0.0 ? pair_kind::active : pair_kind::passive;
    pair.n_ab = g.n_ab;
    pair.separation_m = g.distance;
    pair.p_a = g.p_a;
    pair.p_b = g.p_b;
    return;
  }

  separating_directions directions;
  find_separating_directions(A, B, T_ab, directions);
  for (const separating_direction& d : directions) {
    if (d.separation_m < -limits.max_depth_m) break;
    if (d.separation_m >= tolerance) continue;
    const double direct = share(d.n_ab);
    if (direct <= 0.0) continue;
    placement moved = T_ab;
    const vec3 shift = (tolerance - d.separation_m) * d.n_ab;
    moved.position += shift;
    gjk_cache cold;
    const gjk_result meet = gjk_distance(A, B, moved, 1.05 * tolerance, cold);
    iterations = std::max(iterations, meet.iterations);
    if (meet.outcome != gjk_outcome::separated) continue;
    pair.kind = pair_kind::active;
    pair.weight = direct * separation_weight(d.separation_m, tolerance);
    pair.n_ab = d.n_ab;
    pair.separation_m = d.separation_m;
    pair.p_a = meet.p_a;
    pair.p_b = meet.p_b - shift;
    return;
  }
  pair.weight = 0.0;
  pair.kind = overlapping ? pair_kind::passive : pair_kind::rejected;
}

}  // namespace asperity
