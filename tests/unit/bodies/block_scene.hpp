// Blocks on a table, for tests of free bodies.
#pragma once

#include <gtest/gtest.h>
#include <memory>
#include <utility>

#include "asperity/bodies/free_bodies.hpp"
#include "support/small_models.hpp"
#include "unit/control/drawn.hpp"

namespace asperity::test_support {

inline constexpr double gravity_m_per_s2 = 9.81;
inline const vec3 table_of_blocks_half_m(0.06, 0.04, 0.01), block_half_m(0.012), finger_half_m(0.006, 0.005, 0.004);

/// A block on the table, its middle above the table's.
inline const double block_at_rest_m = table_of_blocks_half_m.z + block_half_m.z;

/// A model with friction of its own: multiplied, the coefficients of two say what a pair has.
[[nodiscard]] inline model_ptr box_with(const vec3& half_m, double friction, const relief_function& relief = nullptr) {
  auto made = relief ? make_textured_box(half_m, 192, relief) : make_flat_box(half_m, 192);
  made.surface = material{};
  made.surface->static_friction = made.surface->dynamic_friction = friction;
  made.surface->combine = friction_combine::multiply;
  return std::make_shared<const textured_model>(std::move(made));
}

/// Few samples: what counts here is what moves.
[[nodiscard]] inline free_bodies_settings quick_settings() {
  free_bodies_settings s;
  s.fields.sample_pitch_m = 1e-3;
  return s;
}

[[nodiscard]] inline free_bodies made(const free_scene& scene, const free_bodies_settings& settings) {
  result<free_bodies> out = free_bodies::make(scene, settings);
  EXPECT_TRUE(out) << (out ? "" : out.error().message);
  return std::move(out).value();
}

/// Half a second or so of a scene by itself.
inline void let_be(free_bodies& bodies, double seconds, double dt_s = 1e-3) {
  for (double t = 0.0; t < seconds; t += dt_s) bodies.advance(dt_s);
}

}  // namespace asperity::test_support
