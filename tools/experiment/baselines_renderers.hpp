// Renderers with the force models of one point.
#pragma once

#include <cstdint>
#include <optional>

#include "asperity/model/scene.hpp"
#include "asperity/render/any_renderer.hpp"

namespace asperity::experiment {

enum class point_force : std::uint8_t {
  minsky,              ///< lateral gain constant
  minsky_by_pressure,  ///< lateral gain in proportion to the normal force
  ho,
  siira_pai,
};

/// The paper's finder, a texture read at one point, and one of the models.
/// @param point_a  see baselines::point_depth   @pre the scene's models are valid
[[nodiscard]] any_renderer make_point_renderer(const scene& bodies, point_force model,
                                               const std::optional<vec3>& point_a);

}  // namespace asperity::experiment
