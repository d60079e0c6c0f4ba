// Settings of the default renderer, without its policies: for who chooses and lets others render.
#pragma once

#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "asperity/planes/near_samples.hpp"

namespace asperity {

/// Settings of make_renderer(). Each default is explained where its struct is.
struct renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are told as support planes, m. 0: no planes, which cost more than the wrench of a light touch.
  double reach_m = 0.0;
  least_motion_settings force{};
  near_sample_limits limits{};
};

}  // namespace asperity
