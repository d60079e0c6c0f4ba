// What a wrap takes for inside: asked at the nodes of its lattice, and along the edges between them.
#pragma once

#include <optional>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/triangle_bvh.hpp"
#include "bake/winding_number.hpp"

namespace asperity::bake {

struct cell_sizes {
  double cell_m = 0.0;
  double thickness_m = 0.0;
  bool asked = false;  ///< the cell is what the user wants, or needs for the thickness
};

/// Inside of the body by its winding number, or within half the thickness of a plate.
class wrapped_body {
 public:
  wrapped_body(const triangle_mesh& body, const triangle_mesh& plates, const cell_sizes& sizes, unsigned threads);

  /// Zero or more inside, less than zero outside.
  [[nodiscard]] float value(const vec3& p) const noexcept;

  /// Where the surface is between a point inside and one outside, by the share of the way.
  [[nodiscard]] double cut(const vec3& inside, const vec3& outside) const noexcept;

 private:
  [[nodiscard]] double winding(const vec3& p) const noexcept;
  [[nodiscard]] double plate_depth(const vec3& p) const noexcept;
  [[nodiscard]] bool in_narrow_gap(const vec3& p) const noexcept;
  [[nodiscard]] double cut_plate(const vec3& inside, const vec3& outside) const noexcept;

  double half_;
  double gap_;
  triangle_mesh surface_;
  std::optional<triangle_bvh> body_;
  std::optional<winding_field> field_;
  std::optional<triangle_bvh> plates_;
};

}  // namespace asperity::bake
