// Settings of the renderers in default_renderer.hpp, without their policies: for who chooses and lets others render.
#pragma once

#include "asperity/cells/cell_settings.hpp"
#include "asperity/collision/contact.hpp"
#include "asperity/collision/finder_settings.hpp"
#include "asperity/collision/near_cells.hpp"
#include "asperity/depth/settings.hpp"
#include "asperity/depth/shared_settings.hpp"
#include "asperity/force/gradient_penalty.hpp"

namespace asperity {

/// Settings of the default policies. Each default is explained where its struct is.
struct renderer_settings {
  cell_settings cells{};
  shared_settings shared{};
  near_limits limits{};
};

/// Settings of the paper's policies.
struct paper_settings {
  finder_settings finder{};
  depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

}  // namespace asperity
