// The threads that a plane renderer's settings ask for.
#pragma once

#include <memory>

#include "asperity/planes/plane_renderer.hpp"
#include "planes/tick_team.hpp"

namespace asperity {

/// Starts them; nothing where the calling thread works alone. Not in a tick.
[[nodiscard]] inline plane_finder::shared_work shared_work_of(const plane_renderer_settings& settings) {
  if (settings.threads <= 1) return {};
  return {std::make_shared<tick_team>(settings.threads, settings.set_up_helper),
          std::make_shared<near_samples>(settings.limits)};
}

}  // namespace asperity
