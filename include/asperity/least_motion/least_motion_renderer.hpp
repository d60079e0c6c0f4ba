// The renderer of least motion, which is the default: for programs that have poses. It holds at any depth.
#pragma once

#include <memory>
#include <utility>

#include "asperity/core/export.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/least_motion.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/planes/plane_depth.hpp"
#include "asperity/planes/plane_finder.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// Settings of make_least_motion_renderer() and make_renderer(). Each default is explained where its struct is.
struct least_motion_renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are reported as support planes, m. 0: no planes, which cost more than the wrench of a light touch.
  double reach_m = 0.0;
  least_motion_settings force{};
  near_sample_limits limits{};
};

/// The least motion of the probe that clears the bodies, on a spring. Its wrench is a function of the pose alone,
/// conservative, and held at any depth. Where they are asked for, it reports plane_renderer's support planes as well.
using least_motion_renderer = basic_renderer<plane_finder, plane_depth, least_motion>;

namespace exits {

/// Makes what the search for ways out needs of the bodies. Allocates, and takes a tenth of a second per body, more for
/// long notches; not for a tick.
/// @pre all bodies of made are there
[[nodiscard]] ASPERITY_API std::shared_ptr<const exit_scene> make_exit_scene(const field_scene& made);

}  // namespace exits

/// The renderer for bodies that were made before, by make_field_scene() and exits::make_exit_scene(): several renderers
/// can share them, and their memory.
/// @pre made are of these bodies, in their order; whether they are as many is checked, whether they are the same is not
/// @return invalid_argument (no probe, no fixed body, bodies missing, ways_of other bodies, a setting out of range)
[[nodiscard]] ASPERITY_API result<least_motion_renderer> make_least_motion_renderer(
    scene bodies, std::shared_ptr<const field_scene> made, std::shared_ptr<const exits::exit_scene> ways_of,
    const least_motion_renderer_settings& settings = {});

/// The renderer for bodies that were made before, by make_field_scene().
/// @pre made are of these bodies, in their order
/// @return invalid_argument (no probe, no fixed body, bodies missing, a setting out of range)
[[nodiscard]] ASPERITY_API result<least_motion_renderer> make_least_motion_renderer(
    scene bodies, std::shared_ptr<const field_scene> made, const least_motion_renderer_settings& settings = {});

/// The renderer for a scene. Makes the fields of its models, which takes fractions of a second each; all memory that
/// its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<least_motion_renderer> make_least_motion_renderer(
    scene bodies, const least_motion_renderer_settings& settings = {});

/// The default renderer for a scene: make_least_motion_renderer().
[[nodiscard]] inline result<least_motion_renderer> make_renderer(scene bodies,
                                                                 const least_motion_renderer_settings& settings = {}) {
  return make_least_motion_renderer(std::move(bodies), settings);
}

}  // namespace asperity
