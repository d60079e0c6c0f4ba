// The second policy: how deep, and which way out.
//
// Contract of a depth backend
// - measure() fills out[i] for contact i of the set, for every contact, in one call: a GPU pays for its round trip once
//   per tick.
// - Heights along n are those of the textured surfaces over the coarse patches (paper, Eq. 8); out.depth_m is their
//   largest difference h_A - h_B over the window. Gradients are about c_A, in world axes, the component along n is 1.
// - Where the patches share no sample: no_overlap is set and every number is zero.
// - Agreement with the double-precision CPU backend is within a bound that the backend states.
// - Nothing in measure() allocates, locks, throws, prints or reads a clock (a GPU backend says what its driver does).
#pragma once

#include <concepts>
#include <span>

#include "asperity/collision/contact.hpp"
#include "asperity/core/status.hpp"
#include "asperity/depth/penetration.hpp"
#include "asperity/model/scene.hpp"

namespace asperity {

/// Base of a backend's `policy_tag`: naming it says "I keep the contract above".
struct depth_tag {};

template <class P>
concept depth_backend = std::derived_from<typename P::policy_tag, depth_tag> &&
    requires(P& backend, const scene_pose& at, const contact_set& contacts, std::span<penetration> out) {
  { backend.measure(at, contacts, out) }
  noexcept->std::same_as<status>;
};

}  // namespace asperity
