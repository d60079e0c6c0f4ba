// One version of a scene that changes, with all that a plane renderer needs of it: made outside of ticks, taken as a
// whole at the beginning of one.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/math.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"

namespace asperity {

class body_tree;
class material_places;
class plane_reader;

/// What a plane renderer looks up of a body in every tick. The same for all bodies of one model.
struct body_facts {
  vec3 centre_b{0.0};       ///< of the sphere beyond whose reach nothing of the body is listed; body frame
  double radius_m = 0.0;    ///< of that sphere
  double half_m = 0.0;      ///< half the thickness of its thinnest parts
  double smallest_m = 0.0;  ///< the smaller diagonal of the body's and the probe's boxes
};

/// A placed_scene with depth fields and the tree of its bodies. Bodies of one model share its field and samples.
struct plane_scene : placed_scene {
  std::shared_ptr<const field_scene> fields;  ///< fixed: one per slot, null where it is free
  std::vector<body_facts> of;                 ///< one per slot
  body_facts probe{};
  std::shared_ptr<const body_tree> tree;  ///< of the bodies where this version has them
  /// Where which material is: of the probe, then one per slot; null without a map.
  std::vector<std::shared_ptr<const material_places>> materials;
  std::shared_ptr<const plane_reader> reader;  ///< of its bodies
  std::size_t most_balls = 0;                  ///< that the sample_tree of a fixed body may have
};

/// What a plane renderer looks up of a body. Reads its whole field; not for a tick.
/// @param probe_diagonal_m,diagonal_m of the boxes of the probe's model and the body's
[[nodiscard]] ASPERITY_API body_facts facts_of(const field_body& body, double probe_diagonal_m, double diagonal_m);

}  // namespace asperity
