// The renderer for control loops: depth fields, and support planes that hold the probe at the surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "asperity/field/field_scene.hpp"
#include "asperity/planes/field_depth.hpp"
#include "asperity/planes/field_finder.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/planes/plane_springs.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// Tells the support planes of a pose, gaps included. A control loop that is given them cannot be pressed through a
/// body: its device thread keeps the probe on the near side of every plane.
using field_renderer = basic_renderer<field_finder, field_depth, plane_springs>;

/// Settings of make_field_renderer().
struct field_renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are told, m; what is not told in time is met by surprise. 0: reach_for() a contact loop of 1 kHz,
  /// and at most a tenth of the smallest body's diagonal.
  double reach_m = 0.0;
  plane_spring_settings springs{};
  near_sample_limits limits{};
};

/// The gaps that a contact loop of this period has to be told, m: 3 v T for a hand of v = 0.6 m/s. With 2 v T a fast
/// touch of a loop of 200 Hz, late by a period, was 0.7 mm deep before its plane was known; with 4 v T, 0.1 mm.
[[nodiscard]] constexpr double reach_for(double period_s) noexcept { return 3.0 * 0.6 * period_s; }

namespace detail {

[[nodiscard]] inline double usual_reach_m(const scene& bodies) noexcept {
  constexpr double usual_period_s = 1e-3, of_the_diagonal = 0.1;
  double reach_m = std::min(reach_for(usual_period_s), of_the_diagonal * bodies.probe->box.diagonal());
  for (const model_ptr& b : bodies.fixed) reach_m = std::min(reach_m, of_the_diagonal * b->box.diagonal());
  return reach_m;
}

}  // namespace detail

/// Says what a scene lacks to be rendered with these fields.
/// @param made of the bodies, or nullptr   @param reach_m see field_renderer_settings
[[nodiscard]] inline result<void> check_field_scene(const scene& bodies, const field_scene* made, double reach_m) {
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

/// The field renderer for bodies that were made before, by make_field_scene(): several renderers can share them.
/// @pre made are of these bodies, in their order
/// @return invalid_argument (no probe, no fixed body, bodies missing, a setting out of range)
[[nodiscard]] inline result<field_renderer> make_field_renderer(scene bodies, std::shared_ptr<const field_scene> made,
                                                                const field_renderer_settings& settings = {}) {
  if (const result<void> ok = check_field_scene(bodies, made.get(), settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.springs); !ok) return ok.error();
  const double reach_m = settings.reach_m > 0.0 ? settings.reach_m : detail::usual_reach_m(bodies);
  field_depth depth(made, bodies, reach_m, settings.limits.readings());
  return field_renderer(std::move(bodies), field_finder(std::move(made), reach_m), std::move(depth),
                        plane_springs(settings.springs), settings.limits);
}

/// The field renderer for a scene. Makes the fields of its models; all memory that its ticks need is taken here.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] inline result<field_renderer> make_field_renderer(scene bodies,
                                                                const field_renderer_settings& settings = {}) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<field_scene> made = make_field_scene(bodies, settings.bodies);
  if (!made) return made.error();
  auto shared = std::make_shared<const field_scene>(std::move(made).value());
  return make_field_renderer(std::move(bodies), std::move(shared), settings);
}

}  // namespace asperity
