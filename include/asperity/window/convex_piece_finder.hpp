// The paper's collision finder: close pairs of convex pieces, clustered into contacts.
#pragma once

#include <cstddef>
#include <memory>

#include "asperity/core/export.hpp"
#include "asperity/render/collision_finder.hpp"
#include "asperity/window/finder_settings.hpp"

namespace asperity {

/// Finds contacts between the convex pieces of the probe and of every fixed body.
///
/// Broad phase: boxes of B's pieces, moved into A's frame and grown by the tolerance, against a static tree over A's.
/// Narrow phase: GJK with cached simplices; for overlaps, separating axes of the real surface
/// (src/window/close_pair.hpp). Clusters (src/window/clustering.hpp) become contacts with a window and patches
/// (src/window/contact_builder.hpp). Contacts are ordered by body and id. docs/explanation/collision.md says what is
/// continuous in the pose and what is known to jump. A contact that grows deeper than max_depth_m keeps its last valid
/// direction and is marked (contact::held).
/// @source paper sections 3.3 and 6.1 (after Kim et al. 2003)
class ASPERITY_API convex_piece_finder {
 public:
  using policy_tag = collision_tag;

  /// Takes all memory that find() needs. Offline.
  /// @pre the scene's models are set and valid
  explicit convex_piece_finder(const scene& s, const finder_settings& settings = {});
  convex_piece_finder(convex_piece_finder&&) noexcept;
  convex_piece_finder& operator=(convex_piece_finder&&) noexcept;
  ~convex_piece_finder();

  /// Contacts at these poses; `out` is cleared first.
  /// @return ok | capacity_reached (statistics() says which) | not_ready (number of poses) | invalid_pose
  /// @rt safe
  status find(const scene_pose& at, contact_set& out) noexcept;

  /// Counters of the last find().
  [[nodiscard]] const finder_statistics& statistics() const noexcept;
  /// Settings for one fixed body, automatic ones filled in. @pre body < number of fixed bodies
  [[nodiscard]] const finder_settings& settings(std::size_t body) const noexcept;
  /// Without the models, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  class search;
  std::unique_ptr<search> search_;
};

static_assert(collision_finder<convex_piece_finder>);

}  // namespace asperity
