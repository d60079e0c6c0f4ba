// Which bodies touch, and where they are in this tick.
#pragma once

#include <span>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// The probe A, which the user moves, and the bodies B that it may touch. Fixed for the life of a renderer.
struct scene {
  model_ptr probe;
  std::vector<model_ptr> fixed;
};

/// Poses of a scene's bodies in one tick. @pre T_wb.size() == scene.fixed.size() and outlives the call
struct scene_pose {
  pose T_wa;
  std::span<const pose> T_wb;
};

/// Centre of mass of the probe in the world: the point c_A that torques and gradients are about.
[[nodiscard]] inline vec3 centre_of_mass_w(const scene& s, const pose& T_wa) noexcept {
  return T_wa * s.probe->mass.centre_of_mass;
}

}  // namespace asperity
