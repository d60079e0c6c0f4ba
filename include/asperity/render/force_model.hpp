// The third policy: from depths to one wrench on the probe.
//
// Contract of a force model
// - accumulate() turns the depths of all contacts into the net wrench on the probe A, about its centre of mass c_A, in
//   world axes, and its stiffness J = dW/dq, q = (translation of c_A; rotation about c_A). B feels the opposite.
// - No contact, no overlap or a gap everywhere: exactly zero wrench and zero stiffness.
// - J is symmetric negative semidefinite, so that an implicit step may use it whatever its size.
// - Nothing in accumulate() allocates, locks, throws, prints or reads a clock. The model may keep nothing between
// calls.
// - capacity_reached says that the wrench is usable and lacks something; what is neither that nor ok leaves a zero.
// - A model whose wrench is not made of the depths alone takes the poses as well, as accumulate()'s first argument.
#pragma once

#include <concepts>
#include <span>

#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/depth_backend.hpp"

namespace asperity {

/// Net effect of all contacts on the probe.
struct contact_force {
  wrench on_probe_w{};  ///< about c_A, world axes, N and N m
  mat6 stiffness{};     ///< dW/dq, N/m, N, N m/m, N m/rad by block
};

/// Base of a force model's `policy_tag`: naming it says "I keep the contract above".
struct force_tag {};

/// A force model that is given the poses too.
template <class P>
concept takes_poses = requires(const P& model, const scene_pose& at, const found_by<P>& found,
                               std::span<const reading_of<P>> depths, contact_force& out) {
  { model.accumulate(at, found, depths, out) }
  noexcept->std::same_as<status>;
};

/// A force model that makes its wrench of the depths alone.
template <class P>
concept takes_depths = requires(const P& model, const found_by<P>& found, std::span<const reading_of<P>> depths,
                                contact_force& out) {
  { model.accumulate(found, depths, out) }
  noexcept->std::same_as<status>;
};

template <class P>
concept force_model = std::derived_from<typename P::policy_tag, force_tag> &&(takes_poses<P> || takes_depths<P>);

/// A force model whose finder knows no contacts tells afterwards what a person would call them: for reports only.
template <class P>
concept describes_contacts = requires(const P& model, contact_set& contacts, std::span<penetration> depths) {
  { model.describe(contacts, depths) }
  noexcept->std::same_as<void>;
};

}  // namespace asperity
