// Two rough boxes in contact at seeded poses, with their cells: for tests of the finder and the depth of near cells.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "asperity/cells/cell_scene.hpp"
#include "asperity/collision/near_cells.hpp"
#include "asperity/core/pose.hpp"
#include "support/random_hulls.hpp"
#include "support/small_models.hpp"

namespace asperity::test_support {

/// A probe and one fixed box, cut coarsely so that slow comparisons stay quick.
struct box_pair {
  scene bodies;
  std::shared_ptr<const cell_scene> cells;

  explicit box_pair(double relief_m = 1e-4) {
    const auto box = [&](const vec3& half) {
      return std::make_shared<const textured_model>(make_textured_box(half, 96, ridges(relief_m, 4e-3)));
    };
    bodies = {box({0.006, 0.004, 0.005}), {box({0.008, 0.009, 0.006})}};
    cell_settings settings;
    settings.pitch_m = 3e-4;
    settings.taper_m = 1e-3;
    settings.depth_limit_m = 1e-3;
    settings.sample_pitch_m = 6e-4;
    settings.feature_pitch_m = 6e-4;
    auto made = make_cell_scene(bodies, settings);
    if (made) cells = std::make_shared<const cell_scene>(std::move(made).value());
  }

  /// A pose of the probe in which the two boxes, without relief, overlap by `depth_m` (negative: are apart), whatever
  /// touches: a face, an edge or a corner. The fixed box is at the origin.
  [[nodiscard]] pose touching(test::uniform_source& random, double depth_m, double turn_rad) const {
    const vec3 from = random.direction();
    // Faces meet squarely, or nearly, where the turn is small.
    const pose upright{exp_rotation(turn_rad * random.direction()), 0.03 * from};
    pose T = upright;
    for (int i = 0; i < 8; ++i) T.position += (-depth_m - separation(T)) * from;
    return T;
  }

 private:
  [[nodiscard]] double separation(const pose& T_wa) const {
    coarse_mesh moved = bodies.probe->mesh;
    for (vec3& p : moved.positions) p = T_wa * p;
    return test::brute_separation(moved, bodies.fixed[0]->mesh);
  }
};

/// Every cell with every tile, and every pair of edges: what a finder may leave out of, but not add to.
[[nodiscard]] inline near_cells everything(const cell_scene& bodies) {
  near_cells out({.cells = 4096, .tiles = 1U << 22, .edges = 1U << 16});
  for (std::uint32_t b = 0; b < bodies.fixed.size(); ++b) {
    const surface_cells &A = *bodies.probe, &B = *bodies.fixed[b];
    for (const bool on_probe : {false, true}) {
      const surface_cells &Y = on_probe ? A : B, &X = on_probe ? B : A;
      for (std::uint32_t c = 0; c < Y.cells.size(); ++c) {
        if (!out.add_cell(b, on_probe, c)) return out;
        for (std::uint32_t t = 0; t < X.tiles.size(); ++t) out.add_tile(t);
      }
    }
    for (std::uint32_t a = 0; a < A.edges.size(); ++a) {
      for (std::uint32_t e = 0; e < B.edges.size(); ++e) out.add_edges({b, a, e});
    }
  }
  out.close();
  return out;
}

}  // namespace asperity::test_support
