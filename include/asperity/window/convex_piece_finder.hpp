// The paper's collision finder: close pairs of convex pieces, clustered into contacts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "asperity/core/export.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/render/collision_finder.hpp"

namespace asperity {

/// Settings of convex_piece_finder. Lengths in metres; 0 means automatic, see resolve().
struct window_finder_settings {
  double tolerance_m = 0.0;         ///< pieces closer than this are in contact
  double max_depth_m = 0.0;         ///< deeper overlaps have no direction of their own: the last valid one is held
  double min_half_size_m = 0.0;     ///< smallest window
  double max_half_size_m = 0.0;     ///< largest window
  double merge_angle_rad = 0.5236;  ///< pairs whose directions differ less may share a contact; 30 degrees
  std::size_t close_pairs = 2048;   ///< capacity, per fixed body
  std::size_t clusters = 32;        ///< capacity, per fixed body, and twice as much for all bodies of a tick
};

/// Counts of the last find(), over all fixed bodies.
struct finder_statistics {
  std::size_t near_bodies = 0;      ///< fixed bodies that were looked into: the others are beyond the tolerance
  std::size_t candidate_pairs = 0;  ///< pairs of pieces whose boxes and spheres came within the tolerance
  std::size_t close_pairs = 0;      ///< pairs within the tolerance (active and passive)
  std::size_t passive_pairs = 0;    ///< close pairs without a direction of the real surface: see pair_kind
  /// Close pairs found by the deep pass: their surfaces have passed each other by more than the tolerance.
  std::size_t deep_pairs = 0;
  std::size_t penetrating_pairs = 0;  ///< pairs whose hulls overlap
  std::size_t dropped_pairs = 0;      ///< close pairs that did not fit: raise window_finder_settings::close_pairs
  std::size_t dropped_clusters = 0;   ///< clusters that did not fit: raise window_finder_settings::clusters
  std::size_t empty_clusters = 0;     ///< clusters without a facing triangle on one side: no contact
  std::size_t held_contacts = 0;      ///< contacts deeper than the limit that keep their last valid direction
  std::size_t unheld_clusters = 0;    ///< clusters that came up deep inside while a contact was held: left out
  std::uint32_t gjk_iterations = 0;   ///< most that one pair took
};

/// The lengths for one pair of bodies, automatic ones filled in.
/// - tolerance: the largest displacement of both textures, so that no fine surface touches outside it, plus 0.5 % of
///   the smaller body's diagonal, so that a contact is there before the touch.
/// - depth limit: half the sum of both bodies' thinnest box sides, at most 10 % of the smaller diagonal: beyond it the
///   way out on the other side may be shorter.
/// - windows: from one tolerance to half the smaller diagonal.
[[nodiscard]] ASPERITY_API window_finder_settings resolve(window_finder_settings s, const textured_model& a,
                                                          const textured_model& b) noexcept;

/// Finds contacts between the convex pieces of the probe and of every fixed body.
///
/// Broad phase: a sphere around either body; boxes of B's pieces, moved into A's frame and grown by the tolerance,
/// against a static tree over A's.
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
  explicit convex_piece_finder(const scene& s, const window_finder_settings& settings = {});
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
  [[nodiscard]] const window_finder_settings& settings(std::size_t body) const noexcept;
  /// Without the models, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  class search;
  std::unique_ptr<search> search_;
};

static_assert(collision_finder<convex_piece_finder>);

}  // namespace asperity
