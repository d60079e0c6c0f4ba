#include "asperity/least_motion/least_motion_renderer.hpp"

#include <limits>
#include <utility>

#include "least_motion/exit_scene.hpp"

namespace asperity {

std::shared_ptr<const exits::exit_scene> exits::make_exit_scene(const field_scene& made) {
  return std::make_shared<const exit_scene>(made);
}

result<least_motion_renderer> make_least_motion_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                         std::shared_ptr<const exits::exit_scene> ways_of,
                                                         const least_motion_renderer_settings& settings) {
  if (const result<void> ok = check_field_scene(bodies, made.get()); !ok) return ok.error();
  if (const result<void> ok = check_reach(settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.force); !ok) return ok.error();
  if (!ways_of || !ways_of->is_of(*made)) {
    return error{error_code::invalid_argument, "the exit scene is of other fields: make it of these, in their order"};
  }
  // A gap that no sample can have, and the finder finds nothing at its first look.
  const double reach_m = settings.reach_m > 0.0 ? settings.reach_m : -std::numeric_limits<double>::infinity();
  plane_depth depth(made, bodies, reach_m, settings.limits.readings());
  least_motion force(*made, std::move(ways_of), bodies.probe->mass.centre_of_mass, settings.force);
  return least_motion_renderer(std::move(bodies), plane_finder(std::move(made), reach_m), std::move(depth),
                               std::move(force), settings.limits);
}

result<least_motion_renderer> make_least_motion_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                         const least_motion_renderer_settings& settings) {
  if (const result<void> ok = check_field_scene(bodies, made.get()); !ok) return ok.error();
  auto ways_of = exits::make_exit_scene(*made);
  return make_least_motion_renderer(std::move(bodies), std::move(made), std::move(ways_of), settings);
}

result<least_motion_renderer> make_least_motion_renderer(scene bodies, const least_motion_renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<field_scene> made = make_field_scene(bodies, settings.bodies);  // refuses a missing model too
  if (!made) return made.error();
  auto shared = std::make_shared<const field_scene>(std::move(made).value());
  return make_least_motion_renderer(std::move(bodies), std::move(shared), settings);
}

}  // namespace asperity
