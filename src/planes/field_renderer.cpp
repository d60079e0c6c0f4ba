#include "asperity/planes/field_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace asperity {

namespace {

double usual_reach_m(const scene& bodies) noexcept {
  constexpr double usual_period_s = 1e-3, of_the_diagonal = 0.1;
  double reach_m = std::min(reach_for(usual_period_s), of_the_diagonal * bodies.probe->box.diagonal());
  for (const model_ptr& b : bodies.fixed) reach_m = std::min(reach_m, of_the_diagonal * b->box.diagonal());
  return reach_m;
}

}  // namespace

result<void> check_field_scene(const scene& bodies, const field_scene* made, double reach_m) {
  const auto bad = [](const char* what) { return error{error_code::invalid_argument, what}; };
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  bool all = bodies.probe && made != nullptr && made->probe && made->fixed.size() == bodies.fixed.size();
  for (std::size_t b = 0; all && b < bodies.fixed.size(); ++b) all = bodies.fixed[b] && made->fixed[b];
  if (!all) {
    return bad("the fields are not as many as the scene's bodies: make_field_scene() makes one for each");
  }
  if (!(std::isfinite(reach_m) && reach_m >= 0.0)) {
    return bad("field renderer settings: reach_m must be a finite length, or 0 for automatic");
  }
  return {};
}

result<field_renderer> make_field_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                           const field_renderer_settings& settings) {
  if (const result<void> ok = check_field_scene(bodies, made.get(), settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.springs); !ok) return ok.error();
  const double reach_m = settings.reach_m > 0.0 ? settings.reach_m : usual_reach_m(bodies);
  field_depth depth(made, bodies, reach_m, settings.limits.readings());
  return field_renderer(std::move(bodies), field_finder(std::move(made), reach_m), std::move(depth),
                        plane_springs(settings.springs), settings.limits);
}

result<field_renderer> make_field_renderer(scene bodies, const field_renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<field_scene> made = make_field_scene(bodies, settings.bodies);
  if (!made) return made.error();
  auto shared = std::make_shared<const field_scene>(std::move(made).value());
  return make_field_renderer(std::move(bodies), std::move(shared), settings);
}

}  // namespace asperity
