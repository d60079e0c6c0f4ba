// What the convex-piece finder prepares once for a body.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "model/body_sphere.hpp"
#include "window/aabb_tree.hpp"
#include "window/convex_shape.hpp"
#include "window/mesh_features.hpp"

namespace asperity {

/// Convex shapes, triangle normals, and trees over both. Body frame.
struct collision_body {
  model_ptr model;
  std::vector<convex_shape> shapes;
  std::vector<vec3> triangle_normals;
  aabb_tree piece_tree;
  aabb_tree triangle_tree;
  body_sphere sphere;  ///< around the spheres of all pieces

  /// Offline: allocates. @pre every piece has a vertex and covers a triangle
  explicit collision_body(model_ptr m) : model(std::move(m)) {
    mesh_features features = make_mesh_features(model->mesh);
    std::vector<bounds> boxes;
    for (const convex_piece& p : model->pieces) {
      shapes.push_back(make_convex_shape(model->mesh, features, p));
      boxes.push_back(shapes.back().box);
    }
    sphere = sphere_around(shapes);
    piece_tree = aabb_tree(boxes);
    triangle_tree = aabb_tree(triangle_boxes(model->mesh));
    triangle_normals = std::move(features.triangle_normals);
  }

  /// Without the model, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(shapes, triangle_normals, piece_tree, triangle_tree);
  }

 private:
  [[nodiscard]] static body_sphere sphere_around(const std::vector<convex_shape>& shapes) noexcept {
    if (shapes.empty()) return {};
    bounds all = shapes.front().box;
    for (const convex_shape& s : shapes) all = {glm::min(all.low, s.box.low), glm::max(all.high, s.box.high)};
    body_sphere out{0.5 * (all.low + all.high), 0.0};
    for (const convex_shape& s : shapes) {
      out.radius_m = std::max(out.radius_m, glm::distance(s.centre, out.centre_b) + s.radius);
    }
    return out;
  }
};

}  // namespace asperity
