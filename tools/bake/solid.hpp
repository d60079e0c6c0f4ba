// Inside or outside of a closed mesh.
#pragma once

#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// The volume that a closed, outward oriented mesh encloses. Refers to the mesh.
class solid {
 public:
  explicit solid(const triangle_mesh& mesh);

  [[nodiscard]] bool holds(const vec3& p) const noexcept;
  [[nodiscard]] const triangle_bvh& surface() const noexcept { return tree_; }

 private:
  [[nodiscard]] bool winds_around(const vec3& p) const noexcept;

  const triangle_mesh& mesh_;
  triangle_bvh tree_;
  std::vector<vec3> normals_;
};

}  // namespace asperity::bake
