// The third policy: from depths to one wrench on the probe.
//
// Contract of a force model
// - accumulate() turns the depths of all contacts into the net wrench on the probe A, about its centre of mass c_A, in
//   world axes, and its stiffness J = dW/dq, q = (translation of c_A; rotation about c_A). B feels the opposite.
// - No contact, no overlap or a gap everywhere: exactly zero wrench and zero stiffness.
// - J is symmetric negative semidefinite, so that an implicit step may use it whatever its size.
// - Nothing in accumulate() allocates, locks, throws, prints or reads a clock. The model may keep nothing between
// calls.
#pragma once

#include <concepts>
#include <span>

#include "asperity/collision/contact.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/depth/penetration.hpp"

namespace asperity {

/// Net effect of all contacts on the probe.
struct contact_force {
  wrench on_probe_w{};  ///< about c_A, world axes, N and N m
  mat6 stiffness{};     ///< dW/dq, N/m, N, N m/m, N m/rad by block
};

/// Base of a force model's `policy_tag`: naming it says "I keep the contract above".
struct force_tag {};

template <class P>
concept force_model = std::derived_from<typename P::policy_tag, force_tag> &&
    requires(const P& model, const contact_set& contacts, std::span<const penetration> depths, contact_force& out) {
  { model.accumulate(contacts, depths, out) }
  noexcept->std::same_as<status>;
};

}  // namespace asperity
