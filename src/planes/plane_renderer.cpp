#include "asperity/planes/plane_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "planes/known_branches.hpp"
#include "planes/renderer_team.hpp"
#include "planes/tick_team.hpp"

namespace asperity {

namespace {

double usual_reach_m(const scene& bodies) noexcept {
  constexpr double usual_period_s = 1e-3, of_the_diagonal = 0.1;
  double reach_m = std::min(reach_for(usual_period_s), of_the_diagonal * bodies.probe->box.diagonal());
  for (const model_ptr& b : bodies.fixed) reach_m = std::min(reach_m, of_the_diagonal * b->box.diagonal());
  return reach_m;
}

// Maps of materials are looked up by the texels, so they have to fit them.
result<void> check_maps(const scene& bodies) {
  if (!bodies.probe->surface_map.empty()) {
    if (const result<void> ok = check_materials(*bodies.probe); !ok) return ok;
  }
  for (const model_ptr& b : bodies.fixed) {
    if (b->surface_map.empty()) continue;
    if (const result<void> ok = check_materials(*b); !ok) return ok;
  }
  return {};
}

}  // namespace

result<void> check_reach(double reach_m) {
  if (std::isfinite(reach_m) && reach_m >= 0.0) return {};
  return error{error_code::invalid_argument, "renderer settings: reach_m must be a finite length, or 0 for automatic"};
}

result<void> check_threads(unsigned threads) {
  if (threads >= 1 && threads <= tick_team::most_threads) return {};
  return error{error_code::invalid_argument, "renderer settings: threads must be from 1 to " +
                                                 std::to_string(tick_team::most_threads) + ", and is " +
                                                 std::to_string(threads)};
}

result<plane_renderer> make_plane_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                           const plane_renderer_settings& settings) {
  if (const result<void> ok = check_field_scene(bodies, made.get()); !ok) return ok.error();
  if (const result<void> ok = check_reach(settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.springs); !ok) return ok.error();
  if (const result<void> ok = check_threads(settings.threads); !ok) return ok.error();
  if (const result<void> ok = check_maps(bodies); !ok) return ok.error();
  const double reach_m = settings.reach_m > 0.0 ? settings.reach_m : usual_reach_m(bodies);
  auto known = std::make_shared<known_branches>(*made, bodies.probe->mass.centre_of_mass);
  auto with = shared_work_of(settings);
  plane_depth depth(made, bodies, reach_m, settings.limits.readings(), known, with.team);
  plane_finder finder(std::move(made), reach_m, std::move(known), std::move(with));
  return plane_renderer(std::move(bodies), std::move(finder), std::move(depth), plane_springs(settings.springs),
                        settings.limits);
}

result<plane_renderer> make_plane_renderer(scene bodies, const plane_renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<field_scene> made = make_field_scene(bodies, settings.bodies);
  if (!made) return made.error();
  auto shared = std::make_shared<const field_scene>(std::move(made).value());
  return make_plane_renderer(std::move(bodies), std::move(shared), settings);
}

}  // namespace asperity
