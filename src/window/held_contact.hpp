// A contact whose direction is held because its bodies overlap too deeply to have a direction of their own.
#pragma once

#include <cmath>
#include <cstdint>

#include "asperity/core/pose.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/window/convex_piece_finder.hpp"
#include "window/clustering.hpp"
#include "window/patch_window.hpp"

namespace asperity {

/// The parts of a contact that let its depth go on growing along its last valid direction.
///
/// Beyond the depth limit the way out on another side of the body may be shorter, so a newly found direction may be
/// wrong. The last valid one is still right, because the probe came in along it. The direction is fixed to B. Both
/// surfaces' heights and the extent of the contact are material: part of them moves with A, part of them stays with B.
struct held_contact {
  vec3 n_b{0.0};                        ///< held direction, unit, from A to B, frame of B; zero: nothing is kept
  vec3 p_a{0.0}, p_b{0.0};              ///< points at the contact's heights on either surface, frames of A and of B
  vec3 last_b{0.0};                     ///< where p_a was in the last tick, frame of B
  vec3 deepest_a{0.0}, deepest_b{0.0};  ///< witness points of the deepest pair, frames of A and of B
  double deepest_extra_m = 0.0;         ///< that pair's depth along its own direction, less its depth along n
  pose T_a_window, T_b_window;          ///< the last valid window's frame (u, v, n)
  bounds extent;                        ///< of the contact in that window's plane; no height

  [[nodiscard]] bool valid() const noexcept { return glm::dot(n_b, n_b) > 0.0; }

  /// The held direction in the world.
  [[nodiscard]] vec3 n_ab_w(const pose& T_wb) const noexcept { return T_wb.rotation * n_b; }

  /// Depth of the deepest pair at these poses, m.
  [[nodiscard]] double depth_m(const pose& T_wa, const pose& T_wb) const noexcept {
    return glm::dot(n_ab_w(T_wb), T_wa * deepest_a - T_wb * deepest_b) + deepest_extra_m;
  }

  /// Separation of the contact along the held direction, m; negative where the surfaces have passed each other.
  [[nodiscard]] double separation_m(const pose& T_wa, const pose& T_wb) const noexcept {
    return glm::dot(n_ab_w(T_wb), T_wb * p_b - T_wa * p_a);
  }

  /// How far the contact's place on A has moved over B since the last tick, m.
  [[nodiscard]] double moved_m(const pose& T_wa, const pose& T_wb) const noexcept {
    return glm::distance(T_wa * p_a, T_wb * last_b);
  }

  /// The extent in the plane of window `w`, moved with A and kept with B.
  [[nodiscard]] plane_box near(const contact_window& w, const pose& T_wa, const pose& T_wb) const noexcept {
    plane_box out;
    out.add(window_projection(w, T_wa * T_a_window), extent, 1.0);
    out.add(window_projection(w, T_wb * T_b_window), extent, 1.0);
    return out;
  }

  /// The contact as a cluster without pairs, frame of A.
  [[nodiscard]] pair_cluster cluster(const pose& T_wa, const pose& T_wb) const noexcept {
    const pose T_ab = inverse(T_wa) * T_wb;
    pair_cluster c;
    c.n_ab = T_ab.rotation * n_b;
    c.place = p_a;
    c.p_a = p_a;
    c.p_b = T_ab * p_b;
    c.height_a_m = glm::dot(c.n_ab, c.p_a);
    c.height_b_m = glm::dot(c.n_ab, c.p_b);
    return c;
  }
};

/// The held contact that belongs to a contact that has just been built.
/// @param cluster  the contact's, frame of A
/// @param deepest  its deepest active pair
/// @param extent   of the contact in its window's plane
/// @rt safe
[[nodiscard]] inline held_contact keep_contact(const contact& c, const pair_cluster& cluster, const close_pair& deepest,
                                               const plane_box& extent, const pose& T_wa, const pose& T_wb) noexcept {
  const contact_window& w = c.window;
  const pose T_ba = inverse(T_wb) * T_wa;
  const pose T_w_window{glm::normalize(glm::quat_cast(mat3(w.u_w, w.v_w, w.n_ab_w))), w.centre_w};
  const double foot = glm::dot(cluster.n_ab, cluster.place);
  held_contact out;
  out.n_b = glm::normalize(T_ba.rotation * cluster.n_ab);
  out.p_a = cluster.place + (cluster.height_a_m - foot) * cluster.n_ab;
  out.p_b = T_ba * (cluster.place + (cluster.height_b_m - foot) * cluster.n_ab);
  out.last_b = T_ba * out.p_a;
  out.deepest_a = deepest.p_a;
  out.deepest_b = T_ba * deepest.p_b;
  out.deepest_extra_m = -deepest.separation_m - glm::dot(cluster.n_ab, deepest.p_a - deepest.p_b);
  out.T_a_window = inverse(T_wa) * T_w_window;
  out.T_b_window = inverse(T_wb) * T_w_window;
  out.extent = {vec3(extent.low, 0.0), vec3(extent.high, 0.0)};
  return out;
}

/// True where A, moving along n, has left B on the far side: the lowest point of A's box lies beyond the highest of
/// B's.
/// @rt safe
[[nodiscard]] inline bool has_passed_through(const bounds& box_a, const bounds& box_b, const vec3& n_ab_w,
                                             const pose& T_wa, const pose& T_wb) noexcept {
  const auto middle_and_reach = [&](const bounds& box, const pose& T) {
    const vec3 n = glm::conjugate(T.rotation) * n_ab_w;
    return vec2(glm::dot(n_ab_w, T * (0.5 * (box.low + box.high))), glm::dot(glm::abs(n), 0.5 * (box.high - box.low)));
  };
  const vec2 a = middle_and_reach(box_a, T_wa), b = middle_and_reach(box_b, T_wb);
  return a.x - a.y > b.x + b.y;
}

}  // namespace asperity
