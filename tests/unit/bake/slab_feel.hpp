// The wavy slab, baked: is the relief the surface's, and does it feel like it?
#pragma once

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "asperity/model/textured_model.hpp"
#include "asperity/window/cpu_depth.hpp"
#include "mapped_shapes.hpp"
#include "support/height_models.hpp"

namespace asperity::bake::shapes {

// RMS over top and bottom, as far as within_m from their middle, of what the textured surface is away from the closed
// form, in units of the form's own RMS.
inline double slab_miss(const wavy_slab& slab, const textured_model& model, double within_m = 1.0) {
  dice roll(1);
  double squares = 0.0, own = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const std::size_t t = roll.below(model.mesh.triangles.size());
    const vec3 up = area_normal(corners(model.mesh, t));
    const auto b = roll.barycentric();
    const auto& uv = model.mesh.triangles[t].uv;
    const vec3 p = model.texture.sample(b[0] * uv[0] + b[1] * uv[1] + b[2] * uv[2]);
    if (std::abs(up.z) < 0.9 * glm::length(up) || std::max(std::abs(p.x), std::abs(p.y)) > within_m) continue;
    const double h = slab.height(p.x, p.y);
    squares += std::pow(std::abs(p.z) - wavy_slab::half_thickness_m - h, 2);
    own += h * h;
  }
  return std::sqrt(squares / own);
}

// A bowl pressed on the surface at many places: what a tick reads from both models.
inline void expect_slab_feel(const wavy_slab& slab, const textured_model& baked, double depth_tolerance,
                             double slope_tolerance) {
  using namespace test_support;
  plate_spec truth;
  truth.half_x = truth.half_y = 0.5 * wavy_slab::side_m;
  truth.thickness = 2.0 * wavy_slab::half_thickness_m;
  truth.texels = 512;
  truth.height = [slab](double x, double y) { return slab.height(x, y); };
  truth.T_body_plate.position.z = wavy_slab::half_thickness_m;
  plate_spec bowl;
  bowl.half_x = bowl.half_y = 0.004;
  bowl.height = [](double x, double y) { return -(x * x + y * y) / (2.0 * 0.004); };
  const model_ptr probe = make_plate(bowl);
  window_depth_settings settings;
  settings.tau_m = 5e-6;
  const scene on_baked{probe, {std::make_shared<const textured_model>(baked)}};
  const scene on_truth{probe, {make_plate(truth)}};
  auto baked_depth = make_cpu_depth(on_baked, settings);
  auto true_depth = make_cpu_depth(on_truth, settings);
  ASSERT_TRUE(baked_depth && true_depth);
  dice roll(7);
  double misses = 0.0, slope_misses = 0.0, slopes = 0.0, deepest = -1.0;
  constexpr int poses = 60;
  for (int i = 0; i < poses; ++i) {
    const vec3 at{roll(-0.012, 0.012), roll(-0.012, 0.012), wavy_slab::half_thickness_m};
    const quat tilt = exp_rotation(vec3{roll(-0.1, 0.1), roll(-0.1, 0.1), roll(-3.0, 3.0)});
    const contact_window window = window_downwards(0.003, at);
    const pose T_wa{tilt * face_down(), at};
    const penetration a = measure_whole(*baked_depth, on_baked, window, T_wa);
    const penetration b = measure_whole(*true_depth, on_truth, window, T_wa);
    misses += std::pow(a.soft_depth_m - b.soft_depth_m, 2) / poses;
    for (std::size_t k = 0; k < 2; ++k) {
      slope_misses += std::pow(a.gradient[k] - b.gradient[k], 2) / poses;
      slopes += b.gradient[k] * b.gradient[k] / poses;
    }
    deepest = std::max(deepest, b.depth_m);
  }
  EXPECT_GT(deepest, 0.3 * slab.amplitude_m) << "the bowl touches the waves";
  EXPECT_GT(std::sqrt(slopes), 0.02) << "and their slopes are felt";
  EXPECT_LT(std::sqrt(misses), depth_tolerance * slab.amplitude_m / 2.0);
  EXPECT_LT(std::sqrt(slope_misses), slope_tolerance * std::sqrt(slopes));
  testing::Test::RecordProperty("depth_miss_percent", std::to_string(200.0 * std::sqrt(misses) / slab.amplitude_m));
  testing::Test::RecordProperty("slope_miss_percent", std::to_string(100.0 * std::sqrt(slope_misses / slopes)));
}

}  // namespace asperity::bake::shapes
