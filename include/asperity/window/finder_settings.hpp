// Settings and counters of the convex-piece finder.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// Settings of convex_piece_finder. Lengths in metres; 0 means automatic, see resolve().
struct finder_settings {
  double tolerance_m = 0.0;         ///< pieces closer than this are in contact
  double max_depth_m = 0.0;         ///< deeper overlaps have no direction of their own: the last valid one is held
  double min_half_size_m = 0.0;     ///< smallest window
  double max_half_size_m = 0.0;     ///< largest window
  double merge_angle_rad = 0.5236;  ///< pairs whose directions differ less may share a contact; 30 degrees
  std::size_t close_pairs = 2048;   ///< capacity, per fixed body
  std::size_t clusters = 32;        ///< capacity, per fixed body
};

/// What the last find() met, over all fixed bodies.
struct finder_statistics {
  std::size_t candidate_pairs = 0;  ///< pairs of pieces whose boxes and spheres came within the tolerance
  std::size_t close_pairs = 0;      ///< pairs within the tolerance (active and passive)
  std::size_t passive_pairs = 0;    ///< close pairs whose direction is a ghost: see pair_kind
  /// Of these, found by the deep pass: the surfaces passed each other by more than the tolerance.
  std::size_t deep_pairs = 0;
  std::size_t penetrating_pairs = 0;  ///< pairs whose hulls overlap
  std::size_t dropped_pairs = 0;      ///< close pairs that did not fit: raise finder_settings::close_pairs
  std::size_t dropped_clusters = 0;   ///< clusters that did not fit: raise finder_settings::clusters
  std::size_t empty_clusters = 0;     ///< clusters without a facing triangle on one side: no contact
  std::size_t held_contacts = 0;      ///< contacts deeper than the limit that keep their last valid direction
  std::size_t unheld_clusters = 0;    ///< clusters that came up deep inside while a contact was held: left out
  std::uint32_t gjk_iterations = 0;   ///< most that one pair took
};

/// The lengths that hold for one pair of bodies, automatic ones filled in.
/// - tolerance: the largest displacement of both textures, so that no fine surface touches outside it, plus 0.5 % of
///   the smaller body's diagonal, so that a contact is there before the touch.
/// - depth limit: half the sum of both bodies' thinnest box sides, at most 10 % of the smaller diagonal: beyond it the
///   way out on the other side may be shorter.
/// - windows: from one tolerance to half the smaller diagonal.
[[nodiscard]] ASPERITY_API finder_settings resolve(finder_settings s, const textured_model& a,
                                                   const textured_model& b) noexcept;

}  // namespace asperity
