// The support planes of the pose where the probe will come to rest: what planes of its present pose cannot know.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/support_plane.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/depth/plane_source.hpp"

namespace asperity {

namespace detail {

/// Where springs and planes balance, as a motion from the pose where both were told, of at most a tenth of a millimetre
/// and 5 mrad: planes further off are too wrong to be followed.
[[nodiscard]] inline vec6 rest_of(const coupling_pull& pull, const support_planes& planes) noexcept {
  constexpr double most_m = 1e-4, most_rad = 5e-3;
  mat6 springs;
  for (std::size_t i = 0; i < 6; ++i) springs(i, i) = i < 3 ? pull.stiffness_n_per_m : pull.stiffness_n_m_per_rad;
  contact_law still;
  still.dissipation_s_per_m = 0.0;
  // A step of one second with the springs in the place of the mass: its velocity is the way.
  const contact_solution s = solve_contact(springs, to_vec6(pull.on_probe_w), {}, 1.0, planes, {}, still);
  if (!s.solved || !is_finite(s.velocity)) return {};
  const double way = std::max(std::sqrt(glm::dot(s.velocity.linear, s.velocity.linear)) / most_m,
                              std::sqrt(glm::dot(s.velocity.angular, s.velocity.angular)) / most_rad);
  return way > 1.0 ? (1.0 / way) * s.velocity : s.velocity;
}

/// Adds a plane, in the place of the one that is furthest from being met at `moved` where the list is full.
inline void add_plane(const support_plane& p, const vec6& moved, support_planes& to) noexcept {
  if (!to.full()) {
    static_cast<void>(to.push_back(p));
    return;
  }
  const auto depth_there = [&](const support_plane& q) { return q.depth_m + dot(q.gradient, moved); };
  support_plane* const least =
      std::min_element(to.begin(), to.end(),
                       [&](const support_plane& q, const support_plane& r) { return depth_there(q) < depth_there(r); });
  if (depth_there(*least) < depth_there(p)) *least = p;
}

}  // namespace detail

/// Completes the planes of a contact by those of the pose where the probe will rest on them.
///
/// Planes are the surface to first order. A curved or textured surface meets the probe where none of them says so; told
/// a period later, the new plane pushes at once, the old one is not needed any more, and a resting probe trembles. So
/// the pose is computed where the coupling's springs and the planes balance, the renderer is asked for the planes
/// there, and those that were not known go in, until nothing new comes: cutting planes for the equilibrium on the true
/// surface. Afterwards the planes agree with the surface where the probe is going to be.
/// @param pull of the coupling at the pose that the planes were told at; nothing is done where it is not known
/// @param planes completed in place
/// @rt safe: at most 6 rounds
/// @source cutting planes: J. E. Kelley, The cutting-plane method for solving convex programs, 1960
inline void predict_planes(const plane_source& planes_near, const coupling_pull& pull,
                           support_planes& planes) noexcept {
  constexpr int most_rounds = 6;
  constexpr double gap_m = 1e-5;          // planes that are further away than this change nothing at that pose
  constexpr double agrees_m = 1e-7;       // of a spring of 50 N/mm: 5 mN
  constexpr double same_sample_m = 2e-5;  // a sample turns with the probe by less than this
  if (!planes_near || planes.empty()) return;
  if (!(pull.stiffness_n_per_m > 0.0) || !(pull.stiffness_n_m_per_rad > 0.0) || !is_finite(pull.on_probe_w)) return;
  plane_list there;
  for (int round = 0; round < most_rounds; ++round) {
    const vec6 moved = detail::rest_of(pull, planes);
    const status answer = planes_near(moved, -gap_m, there);
    if (answer != status::ok && answer != status::capacity_reached) return;
    bool complete = true;
    for (const support_plane& p : there) {
      if (!is_finite(p)) return;
      const bool known = std::any_of(planes.begin(), planes.end(), [&](const support_plane& q) {
        const vec3 apart = q.r_w - p.r_w;
        return q.body == p.body && glm::dot(apart, apart) < same_sample_m * same_sample_m &&
               std::fabs(q.depth_m + dot(q.gradient, moved) - p.depth_m) < agrees_m;
      });
      if (known) continue;
      support_plane from_here = p;
      from_here.depth_m -= dot(p.gradient, moved);
      detail::add_plane(from_here, moved, planes);
      complete = false;
    }
    if (complete) return;
  }
}

}  // namespace asperity
