// From what a renderer found at one probe pose to what the device thread is handed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/control/exchange.hpp"
#include "asperity/control/plane_prediction.hpp"
#include "asperity/control/plane_selection.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// Whether an overlap has no plane of its body and direction among those that were kept: planes that share a direction
/// are up to twice that angle apart.
/// @param same_direction of the plane_selection   @rt safe
[[nodiscard]] inline bool lacks_a_wall(std::span<const support_plane> found, const support_planes& kept,
                                       double same_direction) noexcept {
  const double twice = 2.0 * same_direction * same_direction - 1.0;
  return std::any_of(found.begin(), found.end(), [&](const support_plane& p) {
    return p.depth_m > 0.0 && std::none_of(kept.begin(), kept.end(), [&](const support_plane& k) {
             return k.body == p.body && glm::dot(k.n_ab_w, p.n_ab_w) >= twice;
           });
  });
}

/// W0, J and the support planes of one tick, at the pose and time that it was rendered for. Where the renderer could
/// not answer, or reported a number that is not finite, the contact is empty and carries the status: the wrench goes to
/// zero.
/// @param answer of the renderer, to this pose
/// @param rest   where the contact before was going to rest
/// @rt safe
inline void linearise(const tick& found, status answer, const timed_pose& at, const plane_selection& selection,
                      rest_prediction& rest, linear_contact& out) noexcept {
  out = {};
  out.T_wc = at.T_wc;
  out.time_ns = at.time_ns;
  out.bodies = at.bodies;
  out.answer = answer;
  if (answer != status::ok && answer != status::capacity_reached) return;
  const status selected = select_planes(found.planes, selection, out.planes);
  if (!is_finite(found.force.on_probe_w) || !is_finite(found.force.stiffness) || selected == status::not_finite) {
    out.answer = status::not_finite;
    out.planes.clear();
    return;
  }
  out.known = found.known;
  out.reader = found.reader;
  out.flags = found.flags;
  if (!found.planes.empty() && found.dropped_contacts > 0) out.flags |= tick_flag::planes_left_out;
  if (selected == status::capacity_reached && lacks_a_wall(found.planes, out.planes, selection.same_direction)) {
    out.flags |= tick_flag::planes_left_out;
  }
  rest.complete(found.planes_near, at.pull, at.T_wc, out.planes);
  out.on_probe_w = found.force.on_probe_w;
  out.stiffness = found.force.stiffness;
  out.dropped = static_cast<std::uint32_t>(found.dropped_contacts);
  vec3 direction{0.0};
  double weight = 0.0;
  for (std::size_t i = 0; i < std::min(found.contacts.size(), found.depths.size()); ++i) {
    const double depth = found.depths[i].depth_m;
    if (!(depth > 0.0)) continue;
    direction += depth * found.contacts[i].window.n_ab_w;
    weight += depth;
    out.max_depth_m = std::max(out.max_depth_m, depth);
    ++out.contacts;
  }
  if (weight > 0.0) out.direction_ab_w = direction / weight;
  for (const support_plane& p : out.planes) out.max_depth_m = std::max(out.max_depth_m, p.depth_m);
}

}  // namespace asperity
