// What is touched in a simulated session: an analytic wall, or textured models through the default renderer.
#pragma once

#include <cstddef>
#include <memory>

#include "asperity/render/renderer.hpp"

namespace asperity::simulation {

/// A renderer behind a pointer. Its definition stays in one translation unit, so that the programs with a planted bug
/// share the compiled renderer and compile the loops only.
class touched_scene {
 public:
  touched_scene() = default;
  touched_scene(const touched_scene&) = delete;
  touched_scene& operator=(const touched_scene&) = delete;
  virtual ~touched_scene() = default;
  [[nodiscard]] virtual status step(const scene_pose& at, tick& out) noexcept = 0;
};

inline constexpr std::size_t textured_scene_count = 3;

/// Height of the probe's frame over the world's z = 0 where scene i begins to touch, metres.
[[nodiscard]] double touch_height_m(std::size_t i);

/// Scene i with a renderer of its own; the models are made once. The fixed body's frame is the world's.
[[nodiscard]] std::unique_ptr<touched_scene> make_textured_scene(std::size_t i, double stiffness_n_per_m);

}  // namespace asperity::simulation
