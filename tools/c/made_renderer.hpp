// Renderers chosen at run time, for the handles that hold one.
#pragma once

#include <cstdint>
#include <span>

#include "asperity/c/renderer.h"
#include "c/handles.hpp"

namespace asperity::c {

struct renderer_wish {
  std::uint32_t formulation = ASPERITY_FORMULATION_LEAST_MOTION;
  double stiffness_n_per_m = 0.0;  ///< 0: the formulation's own
  double period_s = 1e-3;          ///< of the loop that asks
  double reach_m = 0.0;            ///< of planes
  double softness_m = 0.0, sharpness = 0.0;
  std::uint32_t grid = 0;
  std::uint32_t threads = 1;  ///< of planes
};

/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] result<any_renderer> make_any_renderer(scene bodies, const renderer_wish& wish);

/// Where the probe comes down onto the first body. @return invalid_argument
[[nodiscard]] result<pose> find_start(any_renderer& feel, const quat& rotation, std::span<const pose> T_wb);

}  // namespace asperity::c
