// Boxes that a probe, a box too, is pressed on: models and depth fields, made once in a program.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"
#include "support/small_models.hpp"

namespace asperity::test_support {

inline const vec3 tool_half_m(0.006, 0.005, 0.004), table_half_m(0.03, 0.03, 0.01), cube_half_m(0.012);

/// Few samples: what counts here is what changes.
inline constexpr field_body_settings few_samples{.sample_pitch_m = 5e-4};

struct box_scene {
  model_ptr tool, table, rough, cube;
  std::shared_ptr<const field_scene> made;

  [[nodiscard]] field_body_ptr field_of(const model_ptr& m) const {
    return made->fixed[m == table ? 0 : (m == rough ? 1 : 2)];
  }
};

/// The probe with a corner down, where few of its samples are near, and the corner's distance from its middle.
[[nodiscard]] inline quat corner_down() {
  const vec3 corner = glm::normalize(tool_half_m), down(0.0, 0.0, -1.0);
  return exp_rotation(std::acos(glm::dot(corner, down)) * glm::normalize(glm::cross(corner, down)));
}
[[nodiscard]] inline double corner_m() { return glm::length(tool_half_m); }

/// A probe; a table and the same with ridges of 50 um; a cube.
[[nodiscard]] inline const box_scene& boxes() {
  static const box_scene made = [] {
    const auto flat = [](const vec3& half, std::uint32_t texels) {
      return std::make_shared<const textured_model>(make_flat_box(half, texels));
    };
    box_scene out{
        .tool = flat(tool_half_m, 192),
        .table = flat(table_half_m, 256),
        .rough = std::make_shared<const textured_model>(make_textured_box(table_half_m, 256, ridges(5e-5, 0.004))),
        .cube = flat(cube_half_m, 192),
        .made = nullptr};
    out.made = std::make_shared<const field_scene>(
        make_field_scene({out.tool, {out.table, out.rough, out.cube}}, few_samples).value());
    return out;
  }();
  return made;
}

}  // namespace asperity::test_support
