// The entry point: three policies, one call per tick.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "asperity/collision/concept.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/depth/concept.hpp"
#include "asperity/force/concept.hpp"

namespace asperity {

/// What one tick found. The spans point into the renderer and live until its next step.
struct tick {
  contact_force force{};                ///< on the probe; zero where the status is not ok or capacity_reached
  vec3 centre_of_mass_w{0.0};           ///< c_A, the point the torque is about
  std::span<const contact> contacts;    ///< what the finder reported
  std::span<const penetration> depths;  ///< one per contact
  std::size_t dropped_contacts = 0;     ///< contacts that did not fit: raise contact_limits
};

/// Feels the contact between a probe and fixed bodies: collision finder, depth backend and force model in a row.
///
///     auto made = asperity::make_renderer(scene);            // the default policies, see default_renderer.hpp
///     asperity::tick tick;
///     if (made && made->step({T_wa, T_wb}, tick) == asperity::status::ok) send(tick.force.on_probe_w);
///
/// Data goes forward only; no stage knows the next. All memory is taken by the constructor.
/// @tparam Finder  who touches whom          (asperity/collision/concept.hpp)
/// @tparam Depth   how deep, and which way   (asperity/depth/concept.hpp)
/// @tparam Force   what that feels like      (asperity/force/concept.hpp)
template <collision_finder Finder, depth_backend Depth, force_model Force>
class basic_renderer {
 public:
  basic_renderer(asperity::scene scene, Finder finder, Depth depth, Force force, contact_limits limits = {})
      : scene_(std::move(scene)),
        finder_(std::move(finder)),
        depth_(std::move(depth)),
        force_(std::move(force)),
        contacts_(limits),
        depths_(limits.contacts) {}

  /// Wrench on the probe at these poses.
  /// @pre at.T_wb.size() == scene().fixed.size()
  /// @return ok | capacity_reached (a usable result that lacks something) | invalid_pose | not_ready | not_finite |
  ///         backend_failed; the last four leave a zero wrench
  /// @rt safe: no allocation, lock, throw, print or clock
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    contacts_.clear();
    if (at.T_wb.size() != scene_.fixed.size()) return status::not_ready;
    if (!is_valid(at.T_wa)) return status::invalid_pose;
    for (const pose& T : at.T_wb) {
      if (!is_valid(T)) return status::invalid_pose;
    }
    const status found = finder_.find(at, contacts_);
    if (found != status::ok && found != status::capacity_reached) return found;

    const std::span<penetration> depths = std::span(depths_).first(contacts_.size());
    if (const status s = depth_.measure(at, contacts_, depths); s != status::ok) return s;
    if (const status s = force_.accumulate(contacts_, depths, out.force); s != status::ok) {
      out.force = {};
      return s;
    }
    if (!is_finite(out.force.on_probe_w)) {
      out.force = {};
      return status::not_finite;
    }
    out.centre_of_mass_w = centre_of_mass_w(scene_, at.T_wa);
    out.contacts = contacts_.contacts();
    out.depths = depths;
    out.dropped_contacts = contacts_.dropped();
    return found;
  }

  [[nodiscard]] const asperity::scene& scene() const noexcept { return scene_; }
  /// The patches behind the last tick's contacts.
  [[nodiscard]] const contact_set& contacts() const noexcept { return contacts_; }
  /// Memory that the renderer takes, bytes: itself, its policies and all that they hold, whether a tick has used it or
  /// not. Its models belong to whoever else shares them: memory_bytes(scene()) counts them.
  /// A policy that has no heap_bytes() counts with its size alone.
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    const auto held = [](const auto& policy) noexcept -> std::size_t {
      if constexpr (reports_heap<std::remove_cvref_t<decltype(policy)>>) {
        return policy.heap_bytes();
      } else {
        return 0;
      }
    };
    return sizeof *this + heap_bytes(scene_.fixed, contacts_, depths_) + held(finder_) + held(depth_) + held(force_);
  }

  [[nodiscard]] Finder& finder() noexcept { return finder_; }
  [[nodiscard]] Depth& depth() noexcept { return depth_; }
  [[nodiscard]] Force& force() noexcept { return force_; }

 private:
  asperity::scene scene_;
  [[no_unique_address]] Finder finder_;
  [[no_unique_address]] Depth depth_;
  [[no_unique_address]] Force force_;
  contact_set contacts_;
  std::vector<penetration> depths_;
};

}  // namespace asperity
