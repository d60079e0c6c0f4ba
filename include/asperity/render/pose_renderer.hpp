// The renderer for programs that have poses and no control loop: depth fields, and the least motion that clears.
#pragma once

#include <limits>
#include <memory>
#include <utility>

#include "asperity/force/least_motion.hpp"
#include "asperity/render/field_renderer.hpp"

namespace asperity {

/// Its wrench is a function of the pose alone, conservative and held at any depth. Asked for, it tells the support
/// planes of the field_renderer as well.
using pose_renderer = basic_renderer<field_finder, field_depth, least_motion>;

/// Settings of make_pose_renderer().
struct pose_renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are told as support planes, m. 0: no planes, which cost more than the wrench of a light touch.
  double reach_m = 0.0;
  least_motion_settings force{};
  near_sample_limits limits{};
};

/// The pose renderer for bodies that were made before, by make_field_scene(): several renderers can share them.
/// @pre made are of these bodies, in their order
/// @return invalid_argument (no probe, no fixed body, bodies missing, a setting out of range)
[[nodiscard]] inline result<pose_renderer> make_pose_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                              const pose_renderer_settings& settings = {}) {
  if (const result<void> ok = check_field_scene(bodies, made.get(), settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.force); !ok) return ok.error();
  // A gap that no sample can have, and the finder finds nothing at its first look.
  const double reach_m = settings.reach_m > 0.0 ? settings.reach_m : -std::numeric_limits<double>::infinity();
  field_depth depth(made, bodies, reach_m, settings.limits.readings());
  least_motion force(*made, bodies.probe->mass.centre_of_mass, settings.force);
  return pose_renderer(std::move(bodies), field_finder(std::move(made), reach_m), std::move(depth), std::move(force),
                       settings.limits);
}

/// The pose renderer for a scene. Makes the fields of its models; all memory that its ticks need is taken here.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] inline result<pose_renderer> make_pose_renderer(scene bodies,
                                                              const pose_renderer_settings& settings = {}) {
  if (bodies.fixed.empty()) {
    return error{error_code::invalid_argument, "the scene has no fixed body: give the probe something to touch"};
  }
  result<field_scene> made = make_field_scene(bodies, settings.bodies);
  if (!made) return made.error();
  auto shared = std::make_shared<const field_scene>(std::move(made).value());
  return make_pose_renderer(std::move(bodies), std::move(shared), settings);
}

}  // namespace asperity
