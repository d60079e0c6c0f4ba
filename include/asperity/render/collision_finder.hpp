// The first of the three policies: who touches whom.
//
// Contract of every collision finder
// - find() reports every place where the probe and a fixed body may touch: all that are closer than its reach,
//   overlapping ones included. What it reports is of its found_type, and find() clears it first.
// - The same poses after the same history give the same bits.
// - Poses are finite; T_wb has one pose per fixed body. What does not fit is dropped, counted in the found_type, and
//   answered with capacity_reached.
// - Nothing in find() allocates, locks, throws, prints or reads a clock.
//
// What a formulation promises besides
// - The paper's (found_type contact_set, convex_piece_finder): contacts between coarse convex pieces, clustered into
//   patches. n_ab is a unit vector from A towards B; a gap has separation > 0, an overlap < 0. A patch lists coarse
//   triangles that can hold a point of the contact inside its window, each once; a superset is allowed. The window is
//   in the world; its centre lies halfway between the surfaces along n and in the middle of the region of contact,
//   which moves continuously where witness points of parallel faces jump. State between ticks (cached simplices,
//   contact ids, window axes) may change the cost and the frame {u, v}, never whether two pieces touch; the direction
//   of a contact that has grown too deep to have one may be kept, and is marked (contact::held).
// - Fields (found_type near_samples, plane_finder): leaves of samples, a superset of those within reach. What it keeps
//   between ticks, bounds of branches, decides which leaves beyond the reach it lists and how sharp its clearance is;
//   no plane depends on it.
#pragma once

#include <concepts>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/contact.hpp"

namespace asperity {

/// Base of a finder's `policy_tag`: naming it says "I keep the contract above", which a signature alone cannot.
struct collision_tag {};

namespace detail {
template <class P>
struct found_by {
  using type = contact_set;
};
template <class P>
requires requires { typename P::found_type; }
struct found_by<P> {
  using type = typename P::found_type;
};
}  // namespace detail

/// What a policy's finder hands on: contacts with patches and windows, unless the policy names another found_type.
/// near_samples is the other one: see plane_finder. The three policies of a renderer must agree on it.
template <class P>
using found_by = typename detail::found_by<P>::type;

template <class P>
concept collision_finder = std::derived_from<typename P::policy_tag, collision_tag> &&
    requires(P& finder, const scene_pose& at, found_by<P>& out) {
  { finder.find(at, out) }
  noexcept->std::same_as<status>;
};

}  // namespace asperity
