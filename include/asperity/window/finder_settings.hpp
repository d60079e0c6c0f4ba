// Settings and counters of the convex-piece finder, and the body data it prepares once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "asperity/window/aabb_tree.hpp"
#include "asperity/window/convex_shape.hpp"
#include "asperity/window/mesh_features.hpp"

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
  std::size_t deep_pairs =
      0;  ///< of these, found by the deep pass: the surfaces passed each other by more than the tolerance
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
[[nodiscard]] inline finder_settings resolve(finder_settings s, const textured_model& a,
                                             const textured_model& b) noexcept {
  const double diagonal = std::min(a.box.diagonal(), b.box.diagonal());
  const auto thinnest = [](const bounds& box) {
    const vec3 size = box.high - box.low;
    return std::min(size.x, std::min(size.y, size.z));
  };
  if (s.tolerance_m <= 0.0) {
    s.tolerance_m = a.report.max_displacement_m + b.report.max_displacement_m + 0.005 * diagonal;
  }
  if (s.max_depth_m <= 0.0) s.max_depth_m = std::min(0.5 * (thinnest(a.box) + thinnest(b.box)), 0.1 * diagonal);
  if (s.min_half_size_m <= 0.0) s.min_half_size_m = s.tolerance_m;
  if (s.max_half_size_m <= 0.0) s.max_half_size_m = std::max(0.5 * diagonal, s.min_half_size_m);
  return s;
}

/// A body as the finder sees it: convex shapes, triangle normals, and trees over both. Body frame.
struct collision_body {
  model_ptr model;
  std::vector<convex_shape> shapes;
  std::vector<vec3> triangle_normals;
  aabb_tree piece_tree;
  aabb_tree triangle_tree;

  /// Offline: allocates. @pre every piece has a vertex and covers a triangle
  explicit collision_body(model_ptr m) : model(std::move(m)) {
    mesh_features features = make_mesh_features(model->mesh);
    std::vector<bounds> boxes;
    for (const convex_piece& p : model->pieces) {
      shapes.push_back(make_convex_shape(model->mesh, features, p));
      boxes.push_back(shapes.back().box);
    }
    piece_tree = aabb_tree(boxes);
    triangle_tree = aabb_tree(triangle_boxes(model->mesh));
    triangle_normals = std::move(features.triangle_normals);
  }

  /// Without the model, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(shapes, triangle_normals, piece_tree, triangle_tree);
  }
};

}  // namespace asperity
