// The third policy: from depths to one wrench on the probe.
//
// Contract of every force model
// - accumulate() turns what was read of all contacts into the net wrench on the probe A, about its centre of mass c_A,
//   in world axes, and its stiffness J = dW/dq, q = (translation of c_A; rotation about c_A). B feels the opposite.
// - No contact, no overlap or a gap everywhere: exactly zero wrench and zero stiffness.
// - J is symmetric negative semidefinite, so that an implicit step may use it whatever its size.
// - It reports contacts as a description of the force, one depth for each. The spans live until the next call.
// - Whoever calls gives room for what each fixed body does to the probe (force_report::by_body), zero everywhere. A model
//   that knows it adds it up there, the sum being the net wrench; one that does not leaves the report without the room.
// - The same for what each reported contact does (force_report::by_contact): as many as contacts, or none.
// - The answer depends on the arguments alone. A model keeps memory from call to call, and no more.
// - Nothing in accumulate() allocates, locks, throws, prints or reads a clock.
// - capacity_reached says that the wrench is usable and lacks something; what is neither that nor ok leaves a zero.
//
// What a formulation promises besides
// - The paper's (gradient_penalty): the wrench is made of the depths alone, whatever the poses are, and the contacts
//   reported are those that were found.
// - Planes (plane_springs): a spring for each direction, on the deepest support plane of that direction.
// - The least motion: the wrench is minus the gradient of an energy that depends on the pose alone.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/render/penetration.hpp"

namespace asperity {

/// Net effect of all contacts on the probe.
struct contact_force {
  wrench on_probe_w{};  ///< about c_A, world axes, N and N m
  mat6 stiffness{};     ///< dW/dq, N/m, N, N m/m, N m/rad by block
};

/// What a force model answers.
struct force_report {
  contact_force force{};
  std::span<const contact> contacts{};    ///< for reports: who pushes, where and which way
  std::span<const penetration> depths{};  ///< one per contact
  std::span<wrench> by_body{};            ///< on the probe by each fixed body, about c_A, world axes; empty: not known
  std::span<wrench> by_contact{};         ///< the same by each of the contacts
};

/// Base of a force model's `policy_tag`: naming it says "I keep the contract above".
struct force_tag {};

template <class P>
concept force_model = std::derived_from<typename P::policy_tag, force_tag> &&
    requires(P& model, const scene_pose& at, const found_by<P>& found, std::span<const reading_of<P>> readings,
             force_report& out) {
  { model.accumulate(at, found, readings, out) }
  noexcept->std::same_as<status>;
};

/// Room for a fixed number of contacts with their depths, taken when it is made.
class reported_contacts {
 public:
  static constexpr std::size_t most = 64;

  reported_contacts() {
    detail::reserve_resident(contacts_, most);
    detail::reserve_resident(depths_, most);
  }

  /// @rt safe
  void clear() noexcept {
    contacts_.clear();
    depths_.clear();
  }
  /// @return false where there is no more room   @rt safe
  bool add(const contact& c, const penetration& d) noexcept {
    if (contacts_.size() == most) return false;
    contacts_.push_back(c);
    depths_.push_back(d);
    return true;
  }
  [[nodiscard]] std::size_t size() const noexcept { return contacts_.size(); }
  [[nodiscard]] std::span<const contact> contacts() const noexcept { return contacts_; }
  [[nodiscard]] std::span<const penetration> depths() const noexcept { return depths_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(contacts_, depths_); }

 private:
  std::vector<contact> contacts_;
  std::vector<penetration> depths_;
};

}  // namespace asperity
