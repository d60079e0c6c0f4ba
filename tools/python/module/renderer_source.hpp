// Renderers of one scene that share what is made of its models, so that each thread can have one.
#pragma once

#include <memory>
#include <string>

#include "asperity/control/control_settings.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/render/any_renderer.hpp"
#include "scene_handle.hpp"

namespace asperity::python {

/// What a Renderer of Python is asked to be.
struct renderer_wish {
  std::string formulation = "least-motion";  ///< or planes, window, exact
  double stiffness_n_per_m = 0.0;            ///< 0: the formulation's own
  double period_s = 1e-3;                    ///< of the loop that asks
  double softness_m = 0.0;                   ///< of least motion; 0: what fits the period
  double sharpness = 0.0;                    ///< of least motion; 0: what fits the period
  double reach_m = 0.0;                      ///< gaps that planes report; 0: what fits the period
  std::uint32_t grid = 64;                   ///< samples per side of a window
  std::string gradient = "soft";             ///< of windows: or central
  std::string lookup = "exact";              ///< of windows: or paper
  std::string backend = "cpu";               ///< of windows: or gl-compute, gl-occlusion
  std::string gpu;                           ///< index or part of the name; empty: the first that works
  bool fallback = false;                     ///< the CPU answers where the GPU does not
  unsigned threads = 1;                      ///< that share a tick of planes
};

/// A scene, and what its renderers share.
class renderer_source {
 public:
  /// Makes what renderers share; allocates, and takes fractions of a second.
  /// @return invalid_argument | bad_mesh | bad_texture
  [[nodiscard]] static result<renderer_source> make(scene bodies, renderer_wish wish);
  /// Of a scene that changes. @return invalid_argument
  [[nodiscard]] static result<renderer_source> make(std::shared_ptr<scene_handle> edited, renderer_wish wish);

  /// Another renderer that answers as every other one of this source, to the bit; of a scene that changes, as it is now.
  /// @param seen where what it has of that scene is written
  [[nodiscard]] result<any_renderer> another(scene_seen* seen = nullptr) const;
  /// Another one whose steps no other thread shares, for one thread of several that have a renderer each.
  [[nodiscard]] result<any_renderer> another_alone() const;
  /// The same for a control loop of these periods.
  /// @param motion_scale workspace_map::scale
  [[nodiscard]] result<any_renderer> another_for(const loop_periods& periods, double motion_scale,
                                                 scene_seen* seen = nullptr) const;

  /// Whether an answer depends on the poses that the same renderer was asked for before: windows hold contacts that grew
  /// too deep.
  [[nodiscard]] bool remembers() const noexcept {
    return wish_.formulation == "window" || wish_.formulation == "exact";
  }
  /// Without fixed bodies where the scene changes.
  [[nodiscard]] const scene& bodies() const noexcept { return bodies_; }
  /// The scene where it changes; otherwise null.
  [[nodiscard]] const std::shared_ptr<scene_handle>& edited() const noexcept { return edited_; }
  /// Whether that scene has changes beyond these. @pre edited()
  [[nodiscard]] bool lacks(const scene_seen& seen) const {
    const std::lock_guard lock(edited_->busy);
    return seen.changes != edited_->changes;
  }
  [[nodiscard]] const renderer_wish& wish() const noexcept { return wish_; }

 private:
  renderer_source(scene bodies, renderer_wish wish) : bodies_(std::move(bodies)), wish_(std::move(wish)) {}

  [[nodiscard]] result<any_renderer> least_motion(double period_s) const;
  [[nodiscard]] result<any_renderer> planes(double reach_m, unsigned threads, scene_seen* seen) const;
  [[nodiscard]] result<any_renderer> window() const;
  [[nodiscard]] result<any_renderer> exact() const;

  // The gaps to tell, fit for the bodies that are there now; and those of a step() that is in no loop.
  [[nodiscard]] double reach_now(double wanted_m) const;
  [[nodiscard]] double usual_reach() const;

  scene bodies_;
  renderer_wish wish_;
  std::shared_ptr<scene_handle> edited_;
  std::shared_ptr<const field_scene> fields_;
  std::shared_ptr<const exits::exit_scene> exits_;
};

}  // namespace asperity::python
