// What the contact thread hands to the device thread: a wrench that knows how it changes, and planes that only push.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "asperity/control/moving_bodies.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/material.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

class plane_reader;

/// Most support planes that a contact carries: those that press where the probe will rest, one for each sample, and
/// those that it meets next when it tilts or slides.
inline constexpr std::size_t most_support_planes = 64;
/// Of these, how many are chosen for test motions; the rest is for where the probe will come to rest.
inline constexpr std::size_t most_selected_planes = 20;

/// Support planes of one contact; dropped() tells how many more were wanted than it could keep.
using support_planes = fixed_vector<support_plane, most_support_planes>;

/// A body of a changing scene that a contact has planes of; once for each two materials of those planes.
struct contact_body {
  std::uint32_t body = 0;                 ///< its slot
  std::uint64_t since = 0;                ///< placed_scene::since of the slot
  std::optional<surface_pair> surface{};  ///< of the probe and it
  std::uint8_t of_probe = 0;              ///< numbers of the materials, as support_plane has them
  std::uint8_t of_body = 0;
};

/// Of how many bodies a contact's planes can be read again.
inline constexpr std::size_t most_read_bodies = 8;

/// Contact wrench on the probe, linear in the probe's pose: W(q) = W0 + J (q - q0). World axes, torque about c_A.
/// The probe's frame c here has its origin in the centre of mass c_A and the body's axes.
/// Held instead of linearised, a wrench one period late is unstable above 70 N/m at 100 Hz; with J no limit was found.
/// Where the renderer knows support planes they are the contact, gaps included, and W0 and J are for reports.
/// @source science, section 4
struct linear_contact {
  wrench on_probe_w{};  ///< W0, N and N m
  mat6 stiffness{};     ///< J = dW/dq, symmetric negative semidefinite
  pose T_wc{};          ///< q0: pose of the probe's centre-of-mass frame that W0 belongs to
  vec3 direction_ab_w{
      0.0};  ///< mean contact direction, weighted by depth; length 1 where all contacts agree, 0 without
  std::int64_t time_ns = 0;              ///< time of q0 (not of the end of the computation)
  double max_depth_m = 0.0;              ///< deepest contact at q0; 0 without contact
  std::uint32_t contacts = 0;            ///< contacts with depth > 0 at q0
  std::uint32_t dropped = 0;             ///< contacts that did not fit
  status answer = status::not_ready;     ///< what the renderer answered at q0
  support_planes planes{};               ///< at q0; empty where the renderer knows none or nothing is near
  const plane_reader* reader = nullptr;  ///< reads them again, while its scene lives; null where nobody can
  fixed_vector<body_place, most_read_bodies> places{};  ///< where the bodies of these planes were at q0, for the reader
  body_places bodies{};                                 ///< where the moving bodies were at q0; the others stand still
  known_motion known{};               ///< how far the probe may go from q0; unlimited where nobody says
  tick_flag flags = tick_flag::none;  ///< what the planes do not answer
  std::uint64_t version = 0;          ///< of the scene that was rendered; 0: one that never changes
  fixed_vector<contact_body, most_support_planes> of{};  ///< whose planes these are; empty where the version is 0
};

/// How long a contact may be felt. An older one goes on holding the probe, and nothing is put out.
struct contact_ageing {
  std::int64_t hold_ns = 50'000'000;  ///< felt in full up to this age
  std::int64_t fade_ns = 50'000'000;  ///< then linearly down to nothing over this time
};

/// Share of the output that a contact of this age allows: 1 up to hold_ns, 0 from hold_ns + fade_ns, linear between.
/// @rt safe
[[nodiscard]] inline double strength_at(std::int64_t age_ns, const contact_ageing& ageing) noexcept {
  if (age_ns <= ageing.hold_ns) return 1.0;
  if (age_ns >= ageing.hold_ns + ageing.fade_ns) return 0.0;
  return 1.0 - static_cast<double>(age_ns - ageing.hold_ns) / static_cast<double>(ageing.fade_ns);
}

/// q - q0: translation of the centre of mass (m) and rotation vector log(R R0^T) (rad), world axes.
/// @rt safe
[[nodiscard]] inline vec6 pose_difference(const pose& T_wc, const pose& T_wc0) noexcept {
  return {T_wc.position - T_wc0.position, log_rotation(T_wc.rotation * glm::conjugate(T_wc0.rotation))};
}

/// Gaps that the next contact should tell, m: least_m and one and a half times the way that the probe has made on this
/// one. A probe that waits at the border of what is known gets half as much again with every contact, up to the
/// renderer's reach; too small a guess costs a lag and no overlap.
/// @param bodies_share of what the contact knows that moving bodies have used up meanwhile; see carried_contact
/// @return infinity where the contact does not say what is known   @rt safe
[[nodiscard]] inline double gaps_for(const linear_contact& contact, const pose& T_wc, double least_m,
                                     double bodies_share = 0.0) noexcept {
  constexpr double times = 1.5;
  if (!contact.known.is_limited()) return std::numeric_limits<double>::infinity();
  const double share = contact.known.share(pose_difference(T_wc, contact.T_wc)) + bodies_share;
  return least_m + times * share * contact.known.way_m;
}

/// A linear contact at one pose.
struct contact_evaluation {
  wrench on_probe_w{};
  mat6 stiffness{};
  bool pulling = false;  ///< the linear wrench would have pulled the probe on, and was set to zero
};

/// Wrench and stiffness at T_wc.
/// Where the linear wrench would pull (n . F > 0) both are zero: a surface pushes only. With contacts that face each
/// other, as in a slot, there is no common direction (mean shorter than one half) and the test is left out: the wrench
/// of a slot does change its sign.
/// @rt safe
[[nodiscard]] inline contact_evaluation evaluate(const linear_contact& contact, const pose& T_wc) noexcept {
  constexpr double agreement = 0.5;
  const wrench w = contact.on_probe_w + to_wrench(contact.stiffness * pose_difference(T_wc, contact.T_wc));
  const vec3& n = contact.direction_ab_w;
  if (glm::dot(n, n) >= agreement * agreement && glm::dot(n, w.force) > 0.0) return {{}, {}, true};
  return {w, contact.stiffness, false};
}

}  // namespace asperity
