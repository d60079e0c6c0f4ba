// The same contact without its slope: what a renderer hands over that knows a wrench and nothing else.
#pragma once

#include <utility>

#include "asperity/control/contact_loop.hpp"

namespace asperity::test_support {

/// A renderer whose stiffness J and support planes are dropped, so that the device thread holds the wrench as it is.
template <contact_renderer Renderer>
class held_force {
 public:
  explicit held_force(Renderer renderer) : renderer_(std::move(renderer)) {}

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const status s = renderer_.step(at, out);
    out.force.stiffness = {};
    out.planes = {};
    return s;
  }

 private:
  Renderer renderer_;
};

}  // namespace asperity::test_support
