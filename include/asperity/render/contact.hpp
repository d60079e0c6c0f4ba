// What the collision finder reports: contacts with a patch and a window.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

/// Square in the world in which a depth is measured: axes u, v across, n along the penetration direction.
/// World frame; u x v = n; half_size_m in metres. Stays fixed while a gradient moves the probe through it.
/// @source paper section 5.1 (orthographic projection along n); the window's size is our choice
struct contact_window {
  vec3 centre_w{0.0};
  vec3 u_w{1.0, 0.0, 0.0};
  vec3 v_w{0.0, 1.0, 0.0};
  vec3 n_ab_w{0.0, 0.0, 1.0};
  double half_size_m = 0.0;
};

/// One contact between the probe A and a fixed body B.
struct contact {
  vec3 p_a_w{0.0};            ///< witness point on A's coarse surface, world
  vec3 p_b_w{0.0};            ///< witness point on B's coarse surface, world
  double separation_m = 0.0;  ///< (p_b - p_a) . n_ab between the coarse surfaces; negative where they overlap
  contact_window window;      ///< its n_ab_w is the contact's direction: unit, from A towards B
  std::uint32_t body = 0;     ///< index of B in scene::fixed
  std::uint32_t id = 0;       ///< the same contact keeps its id from tick to tick
  bool held = false;          ///< too deep for a direction of its own: it keeps the last valid one (held_contact.hpp)
  std::uint32_t first_a = 0, count_a = 0;  ///< patch of A: range in contact_set::triangles
  std::uint32_t first_b = 0, count_b = 0;  ///< patch of B: range in contact_set::triangles
};

/// Fixed sizes of a contact_set.
struct contact_limits {
  std::size_t contacts = 16;
  std::size_t triangles = 16384;  ///< entries of all patches together

  /// Most readings that a depth backend makes of a set of this size.
  [[nodiscard]] std::size_t readings() const noexcept { return contacts; }
};

/// The contacts of one tick with their patches. All memory is taken when it is made.
class contact_set {
 public:
  using limits_type = contact_limits;

  explicit contact_set(contact_limits limits = {}) : limits_(limits) {
    detail::reserve_resident(contacts_, limits.contacts);
    detail::reserve_resident(triangles_, limits.triangles);
  }

  /// @rt safe
  void clear() noexcept {
    contacts_.clear();
    triangles_.clear();
    dropped_ = 0;
  }

  /// Adds a contact with its patches; first_* and count_* are filled in here.
  /// @return false where a limit was hit: the contact is dropped and counted
  /// @rt safe
  bool add(contact c, std::span<const std::uint32_t> patch_a, std::span<const std::uint32_t> patch_b) noexcept {
    if (contacts_.size() == limits_.contacts ||
        triangles_.size() + patch_a.size() + patch_b.size() > limits_.triangles) {
      ++dropped_;
      return false;
    }
    c.first_a = static_cast<std::uint32_t>(triangles_.size());
    c.count_a = static_cast<std::uint32_t>(patch_a.size());
    triangles_.insert(triangles_.end(), patch_a.begin(), patch_a.end());
    c.first_b = static_cast<std::uint32_t>(triangles_.size());
    c.count_b = static_cast<std::uint32_t>(patch_b.size());
    triangles_.insert(triangles_.end(), patch_b.begin(), patch_b.end());
    contacts_.push_back(c);
    return true;
  }

  [[nodiscard]] std::span<const contact> contacts() const noexcept { return contacts_; }
  [[nodiscard]] std::size_t size() const noexcept { return contacts_.size(); }
  /// Coarse triangles of the probe in contact c's patch.
  [[nodiscard]] std::span<const std::uint32_t> patch_a(const contact& c) const noexcept {
    return std::span(triangles_).subspan(c.first_a, c.count_a);
  }
  /// Coarse triangles of the fixed body in contact c's patch.
  [[nodiscard]] std::span<const std::uint32_t> patch_b(const contact& c) const noexcept {
    return std::span(triangles_).subspan(c.first_b, c.count_b);
  }
  /// Contacts that did not fit since clear(): raise contact_limits.
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] const contact_limits& limits() const noexcept { return limits_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(contacts_, triangles_); }

 private:
  contact_limits limits_;
  std::vector<contact> contacts_;
  std::vector<std::uint32_t> triangles_;
  std::size_t dropped_ = 0;
};

}  // namespace asperity
