// The default renderer, for programs that have poses: it holds at any depth.
#pragma once

#include <memory>

#include "asperity/core/export.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/least_motion.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "asperity/planes/field_depth.hpp"
#include "asperity/planes/field_finder.hpp"
#include "asperity/planes/field_renderer.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// Settings of make_renderer(). Each default is explained where its struct is.
struct renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are told as support planes, m. 0: no planes, which cost more than the wrench of a light touch.
  double reach_m = 0.0;
  least_motion_settings force{};
  near_sample_limits limits{};
};

/// The default: the least motion of the probe that clears the bodies, on a spring. Its wrench is a function of the pose
/// alone, conservative, and held at any depth. Asked for, it tells the support planes of the field_renderer as well.
using renderer = basic_renderer<field_finder, field_depth, least_motion>;

namespace exits {

/// What the search for ways out needs of the bodies. Allocates; takes a tenth of a second a body and more for long
/// notches, not for a tick.
/// @pre all bodies of made are there
[[nodiscard]] ASPERITY_API std::shared_ptr<const exit_scene> make_exit_scene(const field_scene& made);

}  // namespace exits

/// The default renderer for bodies that were made before, by make_field_scene() and exits::make_exit_scene(): several
/// renderers can share them, and their memory.
/// @pre made are of these bodies, in their order; whether they are as many is checked, whether they are the same is not
/// @return invalid_argument (no probe, no fixed body, bodies missing, ways_of other bodies, a setting out of range)
[[nodiscard]] ASPERITY_API result<renderer> make_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                          std::shared_ptr<const exits::exit_scene> ways_of,
                                                          const renderer_settings& settings = {});

/// The default renderer for bodies that were made before, by make_field_scene().
/// @pre made are of these bodies, in their order
/// @return invalid_argument (no probe, no fixed body, bodies missing, a setting out of range)
[[nodiscard]] ASPERITY_API result<renderer> make_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                          const renderer_settings& settings = {});

/// The default renderer for a scene. Makes the fields of its models, which takes fractions of a second each; all memory
/// that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<renderer> make_renderer(scene bodies, const renderer_settings& settings = {});

}  // namespace asperity
