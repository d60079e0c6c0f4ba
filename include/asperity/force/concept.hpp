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

#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/depth/concept.hpp"

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
    requires(const P& model, const found_by<P>& found, std::span<const reading_of<P>> depths, contact_force& out) {
  { model.accumulate(found, depths, out) }
  noexcept->std::same_as<status>;
};

/// A force model whose finder knows no contacts tells afterwards what a person would call them: for reports only.
template <class P>
concept describes_contacts = requires(const P& model, contact_set& contacts, std::span<penetration> depths) {
  { model.describe(contacts, depths) }
  noexcept->std::same_as<void>;
};

}  // namespace asperity
