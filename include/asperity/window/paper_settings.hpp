// Settings of the paper's renderer, without its policies: for who chooses and lets others render.
#pragma once

#include "asperity/render/contact.hpp"
#include "asperity/window/depth_settings.hpp"
#include "asperity/window/finder_settings.hpp"
#include "asperity/window/gradient_penalty.hpp"

namespace asperity {

/// Settings of make_paper_renderer(). Each default is explained where its struct is.
struct paper_settings {
  finder_settings finder{};
  depth_settings depth{};
  gradient_penalty_settings force{};
  contact_limits limits{};
};

}  // namespace asperity
