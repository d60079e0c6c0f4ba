// The default renderer, for programs that have poses: it holds at any depth.
#pragma once

#include <limits>
#include <memory>
#include <utility>

#include "asperity/least_motion/exit_scene.hpp"
#include "asperity/least_motion/least_motion.hpp"
#include "asperity/least_motion/renderer_settings.hpp"
#include "asperity/planes/field_depth.hpp"
#include "asperity/planes/field_finder.hpp"
#include "asperity/planes/field_renderer.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// The default: the least motion of the probe that clears the bodies, on a spring. Its wrench is a function of the pose
/// alone, conservative, and held at any depth. Asked for, it tells the support planes of the field_renderer as well.
using renderer = basic_renderer<field_finder, field_depth, least_motion>;

/// The default renderer for bodies that were made before, by make_field_scene() and of that exits::exit_scene: several
/// renderers can share them, and their memory.
/// @pre made are of these bodies, in their order; whether they are as many is checked, whether they are the same is not
/// @return invalid_argument (no probe, no fixed body, bodies missing, ways_of other bodies, a setting out of range)
[[nodiscard]] inline result<renderer> make_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                    std::shared_ptr<const exits::exit_scene> ways_of,
                                                    const renderer_settings& settings = {}) {
  if (const result<void> ok = check_field_scene(bodies, made.get(), settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.force); !ok) return ok.error();
  if (!ways_of || !ways_of->is_of(*made)) {
    return error{error_code::invalid_argument, "the exit scene is of other fields: make it of these, in their order"};
  }
  // A gap that no sample can have, and the finder finds nothing at its first look.
  const double reach_m = settings.reach_m > 0.0 ? settings.reach_m : -std::numeric_limits<double>::infinity();
  field_depth depth(made, bodies, reach_m, settings.limits.readings());
  least_motion force(*made, std::move(ways_of), bodies.probe->mass.centre_of_mass, settings.force);
  return renderer(std::move(bodies), field_finder(std::move(made), reach_m), std::move(depth), std::move(force),
                  settings.limits);
}

/// The default renderer for bodies that were made before, by make_field_scene().
/// @pre made are of these bodies, in their order
/// @return invalid_argument (no probe, no fixed body, bodies missing, a setting out of range)
[[nodiscard]] inline result<renderer> make_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                    const renderer_settings& settings = {}) {
  if (const result<void> ok = check_field_scene(bodies, made.get(), settings.reach_m); !ok) return ok.error();
  auto ways_of = std::make_shared<const exits::exit_scene>(*made);
  return make_renderer(std::move(bodies), std::move(made), std::move(ways_of), settings);
}

/// The default renderer for a scene. Makes the fields of its models, which takes fractions of a second each; all memory
/// that its ticks need is taken here.
/// @return invalid_argument (no probe, no fixed body, a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<renderer> make_renderer(scene bodies, const renderer_settings& settings = {}) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<field_scene> made = make_field_scene(bodies, settings.bodies);  // refuses a missing model too
  if (!made) return made.error();
  auto shared = std::make_shared<const field_scene>(std::move(made).value());
  return make_renderer(std::move(bodies), std::move(shared), settings);
}

}  // namespace asperity
