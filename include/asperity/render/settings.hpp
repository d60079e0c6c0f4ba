// Settings of the renderers in default_renderer.hpp, without their policies: for who chooses and lets others render.
#pragma once

#include "asperity/collision/contact.hpp"
#include "asperity/collision/finder_settings.hpp"
#include "asperity/collision/near_samples.hpp"
#include "asperity/depth/settings.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/force/gradient_penalty.hpp"
#include "asperity/force/least_motion_settings.hpp"

namespace asperity {

/// Settings of the default policies. Each default is explained where its struct is.
struct renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are told as support planes, m. 0: no planes, which cost more than the wrench of a light touch.
  double reach_m = 0.0;
  least_motion_settings force{};
  near_sample_limits limits{};
};

/// Settings of the paper's policies.
struct paper_settings {
  finder_settings finder{};
  depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

}  // namespace asperity
